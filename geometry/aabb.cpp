// SPDX-License-Identifier: MIT
#include "earshot/geometry/aabb.h"

#include <algorithm>
#include <cmath>

namespace earshot::geometry {

namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

// A conversion that overflows is undefined, so what lies beyond float's range never gets to it.
float round_down(double value) noexcept {
    if (value >= static_cast<double>(kLargest)) {
        return std::isinf(value) ? kInfinity : kLargest;
    }
    if (value < -static_cast<double>(kLargest)) {
        return -kInfinity;
    }
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) <= value ? nearest : std::nextafter(nearest, -kInfinity);
}

float round_up(double value) noexcept {
    return -round_down(-value);
}

void Aabb::include(const Vec3& point) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        lower[k] = std::min(lower[k], round_down(point[axis]));
        upper[k] = std::max(upper[k], round_up(point[axis]));
    }
}

}  // namespace earshot::geometry
