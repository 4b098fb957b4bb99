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

void Aabb::include(const Aabb& box) noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], box.lower[k]);
        upper[k] = std::max(upper[k], box.upper[k]);
    }
}

double Aabb::half_area() const noexcept {
    if (is_empty()) {
        return 0.0;
    }
    const double x = static_cast<double>(upper[0]) - static_cast<double>(lower[0]);
    const double y = static_cast<double>(upper[1]) - static_cast<double>(lower[1]);
    const double z = static_cast<double>(upper[2]) - static_cast<double>(lower[2]);
    return x * y + y * z + z * x;
}

}  // namespace earshot::geometry
