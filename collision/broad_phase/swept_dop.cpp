// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_dop.h"

#include "earshot/geometry/aabb.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::collision {

using geometry::Vec3;

namespace {

void place(const Vec3& p, std::array<float, kSlabs>& places) {
    const std::array<double, kSlabs> exact{p.x,
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
    for (std::size_t i = 0; i < kSlabs; ++i) {
        places[i] = static_cast<float>(exact[i]);
    }
}

void cover(const std::array<float, kSlabs>& a,
           const std::array<float, kSlabs>& b,
           const std::array<float, kSlabs>& c,
           float margin,
           std::array<float, kSlabs>& lower,
           std::array<float, kSlabs>& upper) noexcept {
    for (std::size_t i = 0; i < kSlabs; ++i) {
        lower[i] = std::min(a[i], std::min(b[i], c[i]));
        upper[i] = std::max(a[i], std::max(b[i], c[i]));
    }
    float largest = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, std::max(-lower[axis], upper[axis]));
    }
    // A sum is at most three times the largest; it is rounded when it is taken and when the room is
    // added.
    const float room = margin + 0x1p-21F * largest + 0x1p-140F;
    for (std::size_t i = 0; i < kSlabs; ++i) {
        lower[i] -= room;
        upper[i] += room;
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

MotionPlaces::MotionPlaces(const Vec3& from, const Vec3& to) {
    place(from, begin);
    place(to, end);
}

MotionSlabs::MotionSlabs(const MotionPlaces& a,
                         const MotionPlaces& b,
                         const MotionPlaces& c,
                         double margin) noexcept {
    // It counts once per axis.
    const float room = geometry::round_up(3.0 * margin * (1.0 + 0x1p-20));
    cover(a.begin, b.begin, c.begin, room, lower_begin, upper_begin);
    cover(a.end, b.end, c.end, room, lower_end, upper_end);
}

}  // namespace earshot::collision
