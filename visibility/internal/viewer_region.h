// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

namespace earshot::visibility {

/// All that is within `radius` of the centre along every axis.
struct Ball {
    geometry::Vec3 centre{0.0};
    double radius = 0.0;
};

/// Where a viewer is for some frames: the hull of two boxes of one size, about the ends of a part
/// of its way.
class ViewerRegion {
public:
    ViewerRegion() = default;
    /// A viewer that stays.
    explicit ViewerRegion(const geometry::Vec3& point) noexcept : ViewerRegion(point, point, 0.0) {}
    /// All that is within `radius` of the way between two points, by the largest coordinate.
    ViewerRegion(const geometry::Vec3& from, const geometry::Vec3& to, double radius) noexcept;

    /// Errs to the side of false.
    bool contains(const geometry::Vec3& point) const noexcept;

    bool is_point() const noexcept { return from_ == to_ && radius_ == 0.0; }

    /// The boxes, and balls that hold the viewer just as well.
    const geometry::Aabb& begin() const noexcept { return begin_; }
    const geometry::Aabb& end() const noexcept { return end_; }
    Ball begin_ball() const noexcept { return {from_, radius_}; }
    Ball end_ball() const noexcept { return {to_, radius_}; }

private:
    geometry::Vec3 from_{0.0}, to_{0.0};
    double radius_ = 0.0;
    geometry::Aabb begin_{}, end_{};
};

}  // namespace earshot::visibility
