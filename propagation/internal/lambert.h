// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/geometry/types.h"

#include <cmath>
#include <cstdint>
#include <utility>

namespace earshot::propagation {

/// Cosine and sine of `turns` / 2^32 of a turn, at the middle of that step; off by less than 1e-13.
inline std::pair<double, double> point_on_circle(std::uint32_t turns) noexcept {
    // A quarter of a turn at a time, by Taylor's series from its middle.
    constexpr double kQuarter = 0.5 * math::kPi;
    constexpr std::uint32_t kSteps = 1U << 30;
    const double share = (static_cast<double>(turns % kSteps) + 0.5) / kSteps;
    const double x = kQuarter * (share - 0.5);
    const double y = x * x;
    // Each bracket is 1 less y / (n (n - 1)) of the next.
    const auto bracket = [y](double product, double next) {
        return 1.0 - y * (1.0 / product) * next;
    };
    const double c = bracket(
        2.0,
        bracket(12.0,
                bracket(30.0, bracket(56.0, bracket(90.0, bracket(132.0, bracket(182.0, 1.0)))))));
    const double s =
        x *
        bracket(6.0,
                bracket(20.0, bracket(42.0, bracket(72.0, bracket(110.0, bracket(156.0, 1.0))))));
    // The middle of the first quarter lies at 1/8 of a turn; its turn is left to chance anyway.
    switch (turns / kSteps) {
        case 0:
            return {c, s};
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        default:
            return {s, -c};
    }
}

/// A unit direction about a unit normal after Lambert (density cos / pi): the square of its part
/// across the normal is evenly spread, told by the upper half of `chance`, its angle by the lower.
inline geometry::Vec3 lambert_direction(const geometry::Vec3& normal,
                                        std::uint64_t chance) noexcept {
    const double u = (static_cast<double>(chance >> 32) + 0.5) * 0x1p-32;
    const auto [c, s] = point_on_circle(static_cast<std::uint32_t>(chance));
    // Two unit vectors across the normal (Duff et al. 2017).
    const double sign = std::copysign(1.0, normal.z);
    const double a = -1.0 / (sign + normal.z);
    const double b = normal.x * normal.y * a;
    const geometry::Vec3 right(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    const geometry::Vec3 up(b, sign + normal.y * normal.y * a, -normal.y);
    const double r = std::sqrt(u);
    return r * c * right + r * s * up + std::sqrt(1.0 - u) * normal;
}

}  // namespace earshot::propagation
