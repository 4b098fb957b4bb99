// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/ray_packet.h"

#include "earshot/bvh/better_hit.h"
#include "earshot/geometry/aabb.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::bvh {

using geometry::Ray;
using geometry::Vec3;

namespace {

// As FloatRay.
constexpr double kMinCoordinate = 0x1p-40;
constexpr double kMaxCoordinate = 0x1p40;
constexpr double kMinDirection = 0x1p-30;
constexpr double kMaxDirection = 0x1p30;
constexpr double kCornerSlack = 0x1p-20;

// Wider packets overlap so many boxes that single rays are faster.
constexpr float kMaxSpread = 0.15F;

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

}  // namespace

std::size_t RayPacket::gather(std::span<const Ray> rays, double reach) noexcept {
    rays_ = {};
    if (rays.empty()) {
        return 0;
    }
    const Vec3& from = rays[0].origin;
    const double scene = std::max(largest(from), reach);
    const double sum = from.x + from.y + from.z;
    if (!(scene >= kMinCoordinate && scene <= kMaxCoordinate && sum - sum == 0.0)) {
        return 0;
    }
    const Axes axes = axes_of(rays[0].direction);
    const unsigned signs = signs_of(rays[0].direction);
    float lower[2] = {2.0F, 2.0F};
    float upper[2] = {-2.0F, -2.0F};
    std::size_t count = 0;
    for (; count < std::min(rays.size(), kMaxRays); ++count) {
        const Ray& ray = rays[count];
        const double* d = glm::value_ptr(ray.direction);
        const double size = std::abs(d[axes.z]);
        const double inverse = 1.0 / size;
        const auto x = static_cast<float>(d[axes.x] * inverse);
        const auto y = static_cast<float>(d[axes.y] * inverse);
        const float low[2] = {std::min(lower[0], x), std::min(lower[1], y)};
        const float high[2] = {std::max(upper[0], x), std::max(upper[1], y)};
        // What is not a number fails one of these.
        if (!(ray.origin == from && signs_of(ray.direction) == signs && size >= kMinDirection &&
              size <= kMaxDirection && std::abs(x) <= 1.0F && std::abs(y) <= 1.0F &&
              high[0] - low[0] <= kMaxSpread && high[1] - low[1] <= kMaxSpread &&
              ray.t_max >= 0.0)) {
            break;
        }
        std::copy_n(low, 2, lower);
        std::copy_n(high, 2, upper);
        slope_x[count] = x;
        slope_y[count] = y;
        const double depth = ray.t_max * size;
        bound[count] = geometry::round_up(depth * (1.0 + 0x1p-40));
        inside[count] = geometry::round_down(depth * (1.0 - 0x1p-40));
        counts_[count] = 0;
        best_[count].reset();
    }
    if (count == 0) {
        return 0;
    }
    rays_ = rays.first(count);
    reach_ = reach;
    axis[0] = static_cast<std::uint32_t>(axes.x);
    axis[1] = static_cast<std::uint32_t>(axes.y);
    axis[2] = static_cast<std::uint32_t>(axes.z);
    for (std::size_t k = 0; k < 3; ++k) {
        origin[k] = static_cast<float>(glm::value_ptr(from)[axis[k]]);
    }
    sign = (signs >> axes.z & 1U) != 0 ? -1.0F : 1.0F;
    order_shift = static_cast<int>(3 * signs);
    slack = static_cast<float>(kCornerSlack * scene);
    for (std::size_t k = 0; k < 2; ++k) {
        middle[k] = 0.5F * (lower[k] + upper[k]);
        spread[k] = 0.5F * (upper[k] - lower[k]) + 0x1p-22F;
    }
    for (std::size_t i = 0; i < count; ++i) {
        slope_x[i] -= middle[0];
        slope_y[i] -= middle[1];
    }
    for (std::size_t i = count; i < kMaxRays && i % 8 != 0; ++i) {
        slope_x[i] = slope_x[count - 1];
        slope_y[i] = slope_y[count - 1];
        bound[i] = inside[i] = -1.0F;
    }
    return count;
}

void RayPacket::settle(const geometry::MeshView& mesh, std::size_t ray) noexcept {
    const geometry::ShearedRay sheared(rays_[ray]);
    std::optional<geometry::Hit>& best = best_[ray];
    for (std::size_t i = 0; i < counts_[ray]; ++i) {
        const auto [id, near] = candidates_[ray][i];
        if (near > bound[ray]) {
            continue;
        }
        const auto [a, b, c] = geometry::corners(mesh, id);
        const auto hit = sheared.hit(a, b, c, best ? best->t : rays_[ray].t_max, reach_);
        if (hit) {
            const geometry::Hit candidate = {id, hit->t, hit->u, hit->v};
            if (!best || better_hit(candidate, *best)) {
                best = candidate;
            }
        }
    }
    counts_[ray] = 0;
    if (best) {
        const double depth = best->t * largest(rays_[ray].direction);
        bound[ray] = std::min(bound[ray], geometry::round_up(depth * (1.0 + 0x1p-40)));
    }
}

}  // namespace earshot::bvh
