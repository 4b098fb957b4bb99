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

void project(const Vec3& p, std::array<float, kDopLanes>& projections) {
    const std::array<double, kDopLanes> exact{p.x,
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
    for (std::size_t i = 0; i < kDopLanes; ++i) {
        projections[i] = static_cast<float>(exact[i]);
    }
}

void bound(const std::array<float, kDopLanes>& a,
           const std::array<float, kDopLanes>& b,
           const std::array<float, kDopLanes>& c,
           float margin,
           std::array<float, kDopLanes>& lower,
           std::array<float, kDopLanes>& upper) noexcept {
    for (std::size_t i = 0; i < kDopLanes; ++i) {
        lower[i] = std::min(a[i], std::min(b[i], c[i]));
        upper[i] = std::max(a[i], std::max(b[i], c[i]));
    }
    float largest = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max(largest, std::max(-lower[axis], upper[axis]));
    }
    // A projection is at most three times the largest coordinate; it is rounded when it is summed
    // and when it is padded.
    const float padding = margin + 0x1p-21F * largest + 0x1p-140F;
    for (std::size_t i = 0; i < kDopLanes; ++i) {
        lower[i] -= padding;
        upper[i] += padding;
    }
}

}  // namespace

bool disjoint_along_normal(const MovingCorners& a, const MovingCorners& b, double margin) noexcept {
    const Vec3 origin = a.begin[0];
    const auto middle = [&](std::size_t i) { return a.begin[i] + a.end[i]; };
    const Vec3 normal = glm::cross(middle(1) - middle(0), middle(2) - middle(0));
    const double length = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    int side = 0;
    for (const auto& [own, other] : {std::pair(&a.begin, &b.begin), {&a.end, &b.end}}) {
        double lower = 0.0, upper = 0.0, other_lower = 0.0, other_upper = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 mine = (*own)[i] - origin;
            const Vec3 theirs = (*other)[i] - origin;
            const double here = glm::dot(mine, normal);
            const double there = glm::dot(theirs, normal);
            lower = i == 0 ? here : std::min(lower, here);
            upper = i == 0 ? here : std::max(upper, here);
            other_lower = i == 0 ? there : std::min(other_lower, there);
            other_upper = i == 0 ? there : std::max(other_upper, there);
            const Vec3 sizes = glm::max(glm::abs(mine), glm::abs(theirs));
            largest = std::max({largest, sizes.x, sizes.y, sizes.z});
        }
        // A projection is rounded eight times at most; the constant covers underflow.
        const double error = 2.0 * margin * length + 0x1p-48 * largest * length + 1e-290;
        const int now = other_lower - upper > error ? 1 : lower - other_upper > error ? -1 : 0;
        if (now == 0 || now == -side) {
            return false;
        }
        side = now;
    }
    return true;
}

DopExtents::DopExtents(const Vec3& from, const Vec3& to) {
    project(from, begin);
    project(to, end);
}

SweptDop::SweptDop(const DopExtents& a,
                   const DopExtents& b,
                   const DopExtents& c,
                   double margin) noexcept {
    // The margin counts once per axis.
    const float padding = geometry::round_up(3.0 * margin * (1.0 + 0x1p-20));
    bound(a.begin, b.begin, c.begin, padding, lower_begin, upper_begin);
    bound(a.end, b.end, c.end, padding, lower_end, upper_end);
}

double first_overlap(const MovingElement& a, const MovingElement& b) noexcept {
    const auto lower = [](std::span<const Vec3> corners, int axis) {
        double least = corners[0][axis];
        for (const Vec3& corner : corners.subspan(1)) {
            least = std::min(least, corner[axis]);
        }
        return least;
    };
    const auto upper = [](std::span<const Vec3> corners, int axis) {
        double largest = corners[0][axis];
        for (const Vec3& corner : corners.subspan(1)) {
            largest = std::max(largest, corner[axis]);
        }
        return largest;
    };
    // Along an axis the gap from one element to the other is the least of linear functions less
    // the largest of linear functions: it is concave, so not below the line between its values at
    // both ends, and positive for as long as that line is. A gap is rounded once.
    double time = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        for (const auto& [below, above] : {std::pair(&a, &b), std::pair(&b, &a)}) {
            const double at_begin = lower(above->begin, axis) - upper(below->begin, axis);
            const double at_end = lower(above->end, axis) - upper(below->end, axis);
            if (at_begin > 0.0) {
                const double root = at_end > 0.0 ? 2.0 : at_begin / (at_begin - at_end);
                time = std::max(time, root * (1.0 - 0x1p-40));
            }
        }
    }
    return time;
}

}  // namespace earshot::collision
