// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/side_rays.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/directions.h"

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Of the extent of the scene. A point on a surface is off it by a few roundings of 2^-52.
constexpr double kRayOffset = 0x1p-32;

/// The margin along the border of a triangle from which no ray starts, in barycentric coordinates:
/// a point beside an edge may lie on the wrong side of the next triangle by rounding.
constexpr double kBorderMargin = 1e-3;

}  // namespace

Vec3 normal_of(const bvh::MeshBvh& bvh, SideId side) {
    const auto [a, b, c] = bvh.corners(triangle_of(side));
    const Vec3 front = geometry::normalized_or_zero(glm::cross(b - a, c - a));
    return is_back(side) ? -front : front;
}

SideId side_hit(const bvh::MeshBvh& bvh, const Ray& ray, TriangleId triangle) {
    const auto [a, b, c] = bvh.corners(triangle);
    const bool hits_back = glm::dot(glm::cross(b - a, c - a), ray.direction) > 0.0;
    return hits_back ? back_of(triangle) : front_of(triangle);
}

double ray_offset(const bvh::MeshBvh& bvh) {
    return kRayOffset * bvh.max_abs_coordinate();
}

Vec3 cosine_direction(const Vec3& normal, double u, double v) {
    // A point of the unit sphere that touches the plane from above is distributed by Lambert's law
    // as seen from the point of contact.
    const Vec3 direction = normal + on_sphere(2.0 * u - 1.0, 2.0 * math::kPi * v);
    const double length = glm::length(direction);
    return length > 0.0 ? direction / length : normal;
}

Ray random_side_ray(const bvh::MeshBvh& bvh,
                    SideId side,
                    std::uint64_t seed,
                    std::uint64_t stream,
                    std::uint64_t index) {
    const auto [a, b, c] = bvh.corners(triangle_of(side));
    const Vec3 normal = normal_of(bvh, side);
    const double root = std::sqrt(random(seed, stream, index));
    const double along = random(seed, stream + 1, index);
    const auto inset = [](double weight) {
        return kBorderMargin + (1.0 - 3.0 * kBorderMargin) * weight;
    };
    const double of_b = inset(root * (1.0 - along));
    const double of_c = inset(root * along);
    const Vec3 point = a + of_b * (b - a) + of_c * (c - a);
    return {.origin = point + ray_offset(bvh) * normal,
            .direction = cosine_direction(
                normal, random(seed, stream + 2, index), random(seed, stream + 3, index))};
}

void closest_hits(const bvh::MeshBvh& bvh,
                  std::span<const Ray> rays,
                  std::span<const TriangleId> origins,
                  std::span<std::optional<geometry::Hit>> hits,
                  Executor& executor) {
    constexpr std::size_t kGrain = 4096;
    executor.for_each(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        bvh.closest_hits(
            bvh::SecondaryRays{.rays = rays.subspan(begin, end - begin),
                               .origin_triangles = origins.subspan(begin, end - begin)},
            hits.subspan(begin, end - begin));
    });
}

}  // namespace earshot::visibility
