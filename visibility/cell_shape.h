// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/view_cells.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The origin of a leaf's face is the plane of a node, or the boundary of the region.
inline constexpr std::uint32_t kBorder = 0xffffffffU;

/// A convex polygon of a CellShape.
struct CellFace {
    std::vector<std::uint32_t> corners;  ///< counter-clockwise seen from outside
    std::uint32_t node = kBorder;
};

/// The convex polyhedron of a leaf.
class CellShape {
public:
    explicit CellShape(const ViewRegion& region);
    static CellShape empty() { return {}; }

    std::span<const geometry::Vec3> corners() const noexcept { return corners_; }
    std::span<const CellFace> faces() const noexcept { return faces_; }
    /// Cubic metres.
    double volume() const noexcept;
    /// The mean of the corners, a point inside.
    geometry::Vec3 vertex_mean() const noexcept;
    ViewRegion box() const noexcept;
    /// Whether a point is in it, or outside by at most `slack` metres.
    bool contains(const geometry::Vec3& point, double slack = 0.0) const noexcept;

    struct Halves;
    /// Splits the polyhedron by the plane of a node, whose number the new faces get. Corners within
    /// `slack` metres count as on the plane. Empty if one side is empty. Precondition: the normal
    /// has length 1.
    std::optional<Halves> split(const CellNode& plane, std::uint32_t node, double slack) const;

private:
    CellShape() = default;

    std::vector<geometry::Vec3> corners_;
    std::vector<CellFace> faces_;
};

struct CellShape::Halves {
    CellShape back, front;
};

/// The distance from a plane within which a point of the region counts as on it, metres: 1e-9 of
/// the region's diagonal, far less than any cell is wide; but no less than 1e-14 of the largest
/// coordinate, some fifty times its rounding, for small regions far away.
double plane_slack(const ViewRegion& region) noexcept;

/// The polyhedron of every leaf. A leaf that is thinner than the slack has no faces.
std::vector<CellShape> leaf_shapes(const ViewCells& cells);

}  // namespace earshot::visibility
