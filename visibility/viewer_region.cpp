// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/viewer_region.h"

#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace earshot::visibility {

using geometry::Vec3;

ViewerRegion::ViewerRegion(const Vec3& from, const Vec3& to, double radius) noexcept
    : from_(from), to_(to), radius_(radius) {
    begin_.include(from - Vec3(radius));
    begin_.include(from + Vec3(radius));
    end_.include(to - Vec3(radius));
    end_.include(to + Vec3(radius));
}

// The hull is the sum of the way and a cube: a point is in it if it is so near to any point of the
// way. What is lost by rounding is less than the part of the radius that is left out.
bool ViewerRegion::contains(const Vec3& point) const noexcept {
    constexpr double kInside = 1.0 - 1e-3;
    constexpr double kRounding = 0x1p-40;
    if (point == from_) {
        return true;
    }
    const Vec3 way = to_ - from_;
    const double squared = glm::dot(way, way);
    const double along =
        squared > 0.0 ? std::clamp(glm::dot(point - from_, way) / squared, 0.0, 1.0) : 0.0;
    const double rounding =
        kRounding * std::max({geometry::max_abs(from_), geometry::max_abs(to_)});
    return geometry::max_abs(point - (from_ + along * way)) <= kInside * radius_ - rounding;
}

}  // namespace earshot::visibility
