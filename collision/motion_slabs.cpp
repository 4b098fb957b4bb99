// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/motion_slabs.h"

#include "earshot/geometry/aabb.h"

#include <algorithm>
#include <cmath>

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

MotionSlabs::MotionSlabs(std::span<const Vec3, 3> begin,
                         std::span<const Vec3, 3> end,
                         double margin) {
    cover(begin, margin, lower_begin, upper_begin);
    cover(end, margin, lower_end, upper_end);
}

}  // namespace earshot::collision
