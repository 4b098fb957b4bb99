// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/visibility/visible_share.h"

#include <array>
#include <cstddef>

namespace earshot::visibility {

/// A part of the square of a target's parameters, within 0 ... 1.
struct ParameterCell {
    double u0 = 0.0, u1 = 1.0, v0 = 0.0, v1 = 1.0;

    /// Quarter 0 ... 3.
    ParameterCell quarter(std::size_t index) const noexcept;
};

/// Quadrilaterals that bound the lines of sight from a point to a part of a target.
struct CellHull {
    /// The lines of sight lie in the hull of the point and these.
    std::array<geometry::Vec3, 4> far{};
    /// And pass through the hull of these before they reach the target.
    std::array<geometry::Vec3, 4> near{};
};

/// The targets of a point by two parameters, of which equal areas are equal shares.
class ShareCells {
public:
    virtual ~ShareCells() = default;
    /// Cells to begin with: columns along u; further division halves both sides.
    virtual std::size_t columns() const noexcept = 0;
    virtual CellHull hull(const ParameterCell& cell) const noexcept = 0;
    virtual geometry::Vec3 point(double u, double v) const noexcept = 0;
};

/// The part of a ball that faces a point outside of it: u is the azimuth about the axis, v goes
/// with the cosine of the angle to it, from the axis to the outline.
class SphereCells final : public ShareCells {
public:
    SphereCells(const geometry::Vec3& from, const SphereTarget& target) noexcept;

    std::size_t columns() const noexcept override { return 8; }
    CellHull hull(const ParameterCell& cell) const noexcept override;
    geometry::Vec3 point(double u, double v) const noexcept override;

private:
    double cosine_at(double v) const noexcept;
    double depth_at(double cosine) const noexcept;

    geometry::Vec3 from_, axis_, right_, up_;
    double distance_, radius_;
    double cosine_;  // of the outline
};

class ParallelogramCells final : public ShareCells {
public:
    explicit ParallelogramCells(const ParallelogramTarget& target) noexcept : target_(target) {}

    std::size_t columns() const noexcept override { return 1; }
    CellHull hull(const ParameterCell& cell) const noexcept override;
    geometry::Vec3 point(double u, double v) const noexcept override {
        return target_.corner + u * target_.side_u + v * target_.side_v;
    }

private:
    ParallelogramTarget target_;
};

}  // namespace earshot::visibility
