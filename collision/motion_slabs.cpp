// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/motion_slabs.h"

#include "earshot/geometry/aabb.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// Places along the directions, each the sum of up to three coordinates.
std::array<double, MotionSlabs::kSlabs> places(const Vec3& p) {
    return {p.x,
            p.y,
            p.z,
            p.x + p.y,
            p.x - p.y,
            p.y + p.z,
            p.y - p.z,
            p.z + p.x,
            p.z - p.x,
            p.x + p.y + p.z,
            p.x + p.y - p.z,
            p.x - p.y + p.z,
            p.x - p.y - p.z,
            p.x,
            p.y,
            p.z};
}

void cover(std::span<const Vec3, 3> points,
           double margin,
           std::array<float, MotionSlabs::kSlabs>& lower,
           std::array<float, MotionSlabs::kSlabs>& upper) {
    double largest = 0.0;
    for (const Vec3& point : points) {
        largest = std::max({largest, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    }
    // Sums of three are rounded twice; a margin counts once per axis.
    const double room = 3.0 * margin + 0x1p-49 * largest;
    const auto a = places(points[0]);
    const auto b = places(points[1]);
    const auto c = places(points[2]);
    for (std::size_t i = 0; i < lower.size(); ++i) {
        lower[i] = geometry::round_down(std::min({a[i], b[i], c[i]}) - room);
        upper[i] = geometry::round_up(std::max({a[i], b[i], c[i]}) + room);
    }
}

}  // namespace

bool are_apart_along_normal(const MovingCorners& a,
                            const MovingCorners& b,
                            double margin) noexcept {
    const Vec3 origin = a.begin[0];
    const auto middle = [&](std::size_t i) { return a.begin[i] + a.end[i]; };
    const Vec3 normal = glm::cross(middle(1) - middle(0), middle(2) - middle(0));
    const double length = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    int side = 0;
    for (const auto& [own, other] : {std::pair(&a.begin, &b.begin), {&a.end, &b.end}}) {
        double least = 0.0, most = 0.0, other_least = 0.0, other_most = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 mine = (*own)[i] - origin;
            const Vec3 theirs = (*other)[i] - origin;
            const double here = glm::dot(mine, normal);
            const double there = glm::dot(theirs, normal);
            least = i == 0 ? here : std::min(least, here);
            most = i == 0 ? here : std::max(most, here);
            other_least = i == 0 ? there : std::min(other_least, there);
            other_most = i == 0 ? there : std::max(other_most, there);
            const Vec3 sizes = glm::max(glm::abs(mine), glm::abs(theirs));
            largest = std::max({largest, sizes.x, sizes.y, sizes.z});
        }
        // A place is rounded some eight times; products do not vanish beside their bound.
        const double room = 2.0 * margin * length + 0x1p-48 * largest * length + 1e-290;
        const int now = other_least - most > room ? 1 : least - other_most > room ? -1 : 0;
        if (now == 0 || now == -side) {
            return false;
        }
        side = now;
    }
    return true;
}

MotionSlabs::MotionSlabs(std::span<const Vec3, 3> begin,
                         std::span<const Vec3, 3> end,
                         double margin) {
    cover(begin, margin, lower_begin, upper_begin);
    cover(end, margin, lower_end, upper_end);
}

}  // namespace earshot::collision
