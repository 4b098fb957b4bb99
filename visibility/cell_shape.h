// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/view_cells.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Where a face of a leaf comes from: the border of the region, or the plane of a node.
inline constexpr std::uint32_t kBorder = 0xffffffffU;

struct CellFace {
    std::vector<std::uint32_t> corners;  ///< counter-clockwise seen from outside
    std::uint32_t node = kBorder;
};

/// A convex polyhedron.
class CellShape {
public:
    explicit CellShape(const Region& region);
    static CellShape empty() { return {}; }

    std::span<const geometry::Vec3> corners() const noexcept { return corners_; }
    std::span<const CellFace> faces() const noexcept { return faces_; }
    /// Cubic metres.
    double volume() const noexcept;
    /// The mean of the corners: inside.
    geometry::Vec3 middle() const noexcept;
    Region box() const noexcept;
    /// Whether a point is in it, or outside by at most `slack` metres.
    bool contains(const geometry::Vec3& point, double slack = 0.0) const noexcept;

    struct Halves;
    /// Divides it by the plane of a node, whose number the new faces get. Corners within `slack`
    /// metres count as on the plane. Empty if that leaves nothing on one side. Precondition: the
    /// normal has length 1.
    std::optional<Halves> divided(const CellNode& plane, std::uint32_t node, double slack) const;

private:
    CellShape() = default;

    std::vector<geometry::Vec3> corners_;
    std::vector<CellFace> faces_;
};

struct CellShape::Halves {
    CellShape back, front;
};

/// What counts as on a plane within a region, metres: 1e-9 of its diagonal, far less than any cell
/// is wide; but no less than 1e-14 of the largest coordinate, some fifty times its rounding, for
/// small regions far away.
double plane_slack(const Region& region) noexcept;

/// Of every leaf. A leaf that is thinner than the slack has no faces.
std::vector<CellShape> leaf_shapes(const ViewCells& cells);

}  // namespace earshot::visibility
