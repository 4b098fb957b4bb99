// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/bundle.h"

#include "earshot/geometry/aabb.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::bvh {

using geometry::Ray;
using geometry::Vec3;

namespace {

// As FloatRay.
constexpr double kSmallest = 0x1p-40;
constexpr double kLargest = 0x1p40;
constexpr double kShortest = 0x1p-30;
constexpr double kLongest = 0x1p30;
constexpr double kCornerSlack = 0x1p-20;
// An edge function is summed from three products instead of two, each bounded as FloatRay says.
constexpr double kEdge = 5.0;

// Wider bundles meet so many boxes that rays are faster one by one.
constexpr double kMostSpread = 0.15;

double largest(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct Axes {
    std::size_t x = 0, y = 0, z = 0;
};

Axes axes_of(const Vec3& direction) noexcept {
    const double size = largest(direction);
    const std::size_t z = std::abs(direction.x) == size ? 0 : std::abs(direction.y) == size ? 1 : 2;
    const std::size_t x = z == 2 ? 0 : z + 1;
    return {x, x == 2 ? 0 : x + 1, z};
}

unsigned signs_of(const Vec3& v) noexcept {
    return (std::signbit(v.x) ? 1U : 0U) | (std::signbit(v.y) ? 2U : 0U) |
           (std::signbit(v.z) ? 4U : 0U);
}

bool is_in_range(const Ray& ray, double reach) noexcept {
    const double scene = std::max(largest(ray.origin), reach);
    const double size = largest(ray.direction);
    const double sum = (ray.origin.x + ray.origin.y + ray.origin.z) +
                       (ray.direction.x + ray.direction.y + ray.direction.z);
    return scene >= kSmallest && scene <= kLargest && size >= kShortest && size <= kLongest &&
           sum - sum == 0.0 && ray.t_max >= 0.0;
}

}  // namespace

std::size_t Bundle::length(std::span<const Ray> rays, double reach) noexcept {
    if (rays.empty() || !is_in_range(rays[0], reach)) {
        return 0;
    }
    const Axes axes = axes_of(rays[0].direction);
    const unsigned signs = signs_of(rays[0].direction);
    double lower[2] = {2.0, 2.0};
    double upper[2] = {-2.0, -2.0};
    std::size_t count = 0;
    for (; count < std::min(rays.size(), kMost); ++count) {
        const Ray& ray = rays[count];
        const double* d = glm::value_ptr(ray.direction);
        const double inverse = 1.0 / std::abs(d[axes.z]);
        const double slopes[2] = {d[axes.x] * inverse, d[axes.y] * inverse};
        if (ray.origin != rays[0].origin || signs_of(ray.direction) != signs ||
            !is_in_range(ray, reach) || std::abs(slopes[0]) > 1.0 || std::abs(slopes[1]) > 1.0) {
            break;
        }
        for (std::size_t k = 0; k < 2; ++k) {
            lower[k] = std::min(lower[k], slopes[k]);
            upper[k] = std::max(upper[k], slopes[k]);
        }
        if (upper[0] - lower[0] > kMostSpread || upper[1] - lower[1] > kMostSpread) {
            break;
        }
    }
    return count;
}

void Bundle::set(std::span<const Ray> rays, double reach) noexcept {
    rays_ = rays;
    reach_ = reach;
    const Axes axes = axes_of(rays[0].direction);
    axis[0] = static_cast<std::uint32_t>(axes.x);
    axis[1] = static_cast<std::uint32_t>(axes.y);
    axis[2] = static_cast<std::uint32_t>(axes.z);
    const double scene = std::max(largest(rays[0].origin), reach);
    for (std::size_t k = 0; k < 3; ++k) {
        origin[k] = static_cast<float>(glm::value_ptr(rays[0].origin)[axis[k]]);
    }
    sign = std::signbit(glm::value_ptr(rays[0].direction)[axes.z]) ? -1.0F : 1.0F;
    order_shift = static_cast<int>(3 * signs_of(rays[0].direction));
    slack = static_cast<float>(kCornerSlack * scene);
    edge_slack = static_cast<float>(kEdge * kCornerSlack * scene);
    float lower[2] = {2.0F, 2.0F};
    float upper[2] = {-2.0F, -2.0F};
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double* d = glm::value_ptr(rays[i].direction);
        const double size = std::abs(d[axes.z]);
        const double inverse = 1.0 / size;
        slope_x[i] = static_cast<float>(d[axes.x] * inverse);
        slope_y[i] = static_cast<float>(d[axes.y] * inverse);
        lower[0] = std::min(lower[0], slope_x[i]);
        upper[0] = std::max(upper[0], slope_x[i]);
        lower[1] = std::min(lower[1], slope_y[i]);
        upper[1] = std::max(upper[1], slope_y[i]);
        const double depth = rays[i].t_max * size;
        bound[i] = geometry::round_up(depth * (1.0 + 0x1p-40));
        inside[i] = geometry::round_down(depth * (1.0 - 0x1p-40));
        counts_[i] = 0;
        best_[i].reset();
    }
    for (std::size_t k = 0; k < 2; ++k) {
        middle[k] = 0.5F * (lower[k] + upper[k]);
        spread[k] = 0.5F * (upper[k] - lower[k]) + 0x1p-22F;
    }
    // The slopes' rounding counts as corners' (FloatRay: the shear's error).
    for (std::size_t i = 0; i < rays.size(); ++i) {
        slope_x[i] -= middle[0];
        slope_y[i] -= middle[1];
    }
    for (std::size_t i = rays.size(); i < kMost; ++i) {
        slope_x[i] = slope_x[rays.size() - 1];
        slope_y[i] = slope_y[rays.size() - 1];
        bound[i] = inside[i] = -1.0F;
    }
}

void Bundle::settle(const geometry::MeshView& mesh, std::size_t ray) noexcept {
    const geometry::ShearedRay sheared(rays_[ray]);
    std::optional<geometry::Hit>& best = best_[ray];
    for (std::size_t i = 0; i < counts_[ray]; ++i) {
        const auto [id, near] = candidates_[ray][i];
        if (near > bound[ray]) {
            continue;
        }
        const geometry::Triangle& triangle = mesh.triangles[id];
        const auto hit = sheared.hit(mesh.positions[triangle[0]],
                                     mesh.positions[triangle[1]],
                                     mesh.positions[triangle[2]],
                                     best ? best->t : rays_[ray].t_max,
                                     reach_);
        if (hit && (!best || hit->t < best->t || id < best->triangle)) {
            best = {id, hit->t, hit->u, hit->v};
        }
    }
    counts_[ray] = 0;
    if (best) {
        const double depth = best->t * largest(rays_[ray].direction);
        bound[ray] = std::min(bound[ray], geometry::round_up(depth * (1.0 + 0x1p-40)));
    }
}

}  // namespace earshot::bvh
