// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace earshot::geometry {

/// Axis-aligned box in single precision that contains its exact contents: every bound is rounded
/// outward, so a miss of the box is a miss of what is in it.
struct Aabb {
    std::array<float, 3> lower{std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::infinity()};
    std::array<float, 3> upper{-std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity()};

    /// The box of nothing (lower = +infinity, upper = -infinity), which every include() replaces.
    static Aabb empty() noexcept { return {}; }

    bool is_empty() const noexcept { return lower[0] > upper[0]; }
    void include(const Vec3& point) noexcept;  ///< rounds outward; precondition: finite
    void include(const Aabb& box) noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            lower[k] = box.lower[k] < lower[k] ? box.lower[k] : lower[k];
            upper[k] = box.upper[k] > upper[k] ? box.upper[k] : upper[k];
        }
    }

    /// Half the surface area, in square metres; 0 for the empty box.
    double half_area() const noexcept {
        if (is_empty()) {
            return 0.0;
        }
        const double x = static_cast<double>(upper[0]) - static_cast<double>(lower[0]);
        const double y = static_cast<double>(upper[1]) - static_cast<double>(lower[1]);
        const double z = static_cast<double>(upper[2]) - static_cast<double>(lower[2]);
        return x * y + y * z + z * x;
    }

    /// The largest absolute value of a coordinate, in metres; 0 for the empty box.
    double max_abs_coordinate() const noexcept {
        double largest = 0.0;
        for (std::size_t k = 0; k < 3 && !is_empty(); ++k) {
            largest = std::max({largest,
                                std::abs(static_cast<double>(lower[k])),
                                std::abs(static_cast<double>(upper[k]))});
        }
        return largest;
    }

    friend bool operator==(const Aabb&, const Aabb&) = default;
};

/// The largest float not above, and the smallest not below, `value`; among the floats are the
/// infinities, so 1e300 goes down to the largest finite float and up to infinity.
inline float round_down(double value) noexcept {
    // A conversion that overflows is undefined, so what lies beyond float's range never gets there.
    constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (!(value < kLargest)) {
        return value > kLargest && value - value != 0.0 ? kInfinity
                                                        : std::numeric_limits<float>::max();
    }
    if (value < -kLargest) {
        return -kInfinity;
    }
    const auto nearest = static_cast<float>(value);
    if (static_cast<double>(nearest) <= value) {
        return nearest;
    }
    // The next float below: of positive ones the bits count up, of negative ones down.
    const auto bits = std::bit_cast<std::int32_t>(nearest);
    constexpr std::int32_t kLeastNegative = std::numeric_limits<std::int32_t>::min() + 1;
    return std::bit_cast<float>(bits > 0 ? bits - 1 : nearest == 0.0F ? kLeastNegative : bits + 1);
}
inline float round_up(double value) noexcept {
    return -round_down(-value);
}

}  // namespace earshot::geometry
