// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>

namespace earshot::audio {

inline double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) noexcept {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline std::array<double, 3> cross(const std::array<double, 3>& a,
                                   const std::array<double, 3>& b) noexcept {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline std::array<double, 3> difference(const std::array<double, 3>& a,
                                        const std::array<double, 3>& b) noexcept {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline double length(const std::array<double, 3>& a) noexcept {
    return std::sqrt(dot(a, a));
}

inline std::array<double, 3> scaled(const std::array<double, 3>& a, double factor) noexcept {
    return {factor * a[0], factor * a[1], factor * a[2]};
}

}  // namespace earshot::audio
