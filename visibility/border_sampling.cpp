// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/border_sampling.h"

#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::visibility {

using geometry::Ray;
using geometry::Vec3;

namespace {

/// The unit vector perpendicular to a side of a triangle and to the view direction that points out
/// of the triangle. `view`: from the eye to a corner of the side; `inside`: from there to the third
/// corner.
Vec3 outward(const Vec3& view, const Vec3& side, const Vec3& inside) noexcept {
    const Vec3 across = geometry::normalized_or_zero(glm::cross(view, side));
    return glm::dot(across, inside) > 0.0 ? -across : across;
}

/// The points where a plane intersects the sides of a triangle.
struct PlaneSection {
    std::array<Vec3, 2> ends;
    int count = 0;
};

PlaneSection section(const Corners& triangle, const Vec3& normal, const Vec3& on_plane) noexcept {
    PlaneSection result;
    for (std::size_t i = 0; i < 3 && result.count < 2; ++i) {
        const Vec3& a = triangle[i];
        const Vec3& b = triangle[(i + 1) % 3];
        const double from = glm::dot(normal, a - on_plane);
        const double to = glm::dot(normal, b - on_plane);
        if ((from < 0.0) != (to < 0.0)) {
            result.ends[static_cast<std::size_t>(result.count++)] =
                a + from / (from - to) * (b - a);
        }
    }
    return result;
}

}  // namespace

// Wonka et al. 2006, section 4.1. Two deviations: the third corner decides which way is out of a
// side, not the triangle's facing; and the bisector of a sharp corner is that of its two sides.
std::array<Vec3, kPolygonVertices> enlarged_polygon(const Vec3& eye,
                                                    const Corners& triangle,
                                                    double angle) noexcept {
    std::array<Vec3, kPolygonVertices> points;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& corner = triangle[i];
        const Vec3 view = corner - eye;
        const Vec3 next = triangle[(i + 1) % 3] - corner;
        const Vec3 previous = triangle[(i + 2) % 3] - corner;
        const Vec3 off_previous = outward(view, previous, next);
        const Vec3 off_next = outward(view, next, previous);
        Vec3 middle = off_previous + off_next;
        if (glm::dot(off_previous, off_next) <= 0.0) {
            const Vec3 away =
                -geometry::normalized_or_zero(next) - geometry::normalized_or_zero(previous);
            const double squared = glm::dot(view, view);
            middle = squared > 0.0 ? away - glm::dot(away, view) / squared * view : away;
        }
        const double offset = angle * glm::length(view);
        points[3 * i] = corner + offset * off_previous;
        points[3 * i + 1] = corner + offset * geometry::normalized_or_zero(middle);
        points[3 * i + 2] = corner + offset * off_next;
    }
    return points;
}

std::optional<Vec3> expected_hit(const Ray& ray,
                                 const Corners& triangle,
                                 double max_distance) noexcept {
    const Vec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    const double speed = glm::dot(normal, ray.direction);
    const double height = glm::dot(normal, triangle[0] - ray.origin);
    const double t = height / speed;
    // Also false where the ray runs along the plane.
    if (!(t > 0.0 && t * glm::length(ray.direction) <= max_distance)) {
        return std::nullopt;
    }
    return ray.origin + t * ray.direction;
}

// Wonka et al. 2006, section 4.2. The ray passes the end of the occluder, in the plane of both
// rays, that is nearer to the old ray.
std::optional<Ray> reverse_ray(const BlockedRay& blocked,
                               const ViewRegion& region,
                               double gap) noexcept {
    const Vec3& eye = blocked.ray.origin;
    const Vec3 old_view = blocked.old_hit - eye;
    const Vec3 normal = glm::cross(blocked.hit - eye, old_view);
    const PlaneSection line = section(blocked.occluder, normal, eye);
    if (line.count < 2) {
        return std::nullopt;
    }
    const auto alignment = [&](const Vec3& point) {
        const Vec3 view = point - eye;
        return glm::dot(view, old_view) / std::max(glm::length(view), 1e-300);
    };
    const bool is_first = alignment(line.ends[0]) >= alignment(line.ends[1]);
    const Vec3& edge = line.ends[is_first ? 0 : 1];
    const Vec3 past = edge + gap * geometry::normalized_or_zero(edge - line.ends[is_first ? 1 : 0]);
    const Vec3 towards = past - blocked.expected;
    // The region must lie beyond the occluder's edge.
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    const geometry::Interval inside =
        clip(blocked.expected, towards, region, {-kUnbounded, kUnbounded});
    if (inside.is_empty() || !(inside.min >= 1.0) || !std::isfinite(inside.min)) {
        return std::nullopt;
    }
    return Ray{blocked.expected + inside.min * towards, -towards};
}

}  // namespace earshot::visibility
