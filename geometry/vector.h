// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::geometry {

/// False for numbers, vectors and matrices with a component that is infinite or not a number.
inline bool is_finite(double value) noexcept {
    return std::isfinite(value);
}
inline bool is_finite(const Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
inline bool is_finite(const glm::dmat3& m) noexcept {
    return is_finite(m[0]) && is_finite(m[1]) && is_finite(m[2]);
}
inline bool is_finite(const glm::dmat4& m) noexcept {
    for (int column = 0; column < 4; ++column) {
        if (!is_finite(Vec3(m[column])) || !std::isfinite(m[column].w)) {
            return false;
        }
    }
    return true;
}

/// The largest absolute value of a component.
inline double max_abs(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The order by x, then y, then z.
inline bool lexicographic_less(const Vec3& a, const Vec3& b) noexcept {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// The vector divided by its length; not finite if the length is 0 or infinite.
inline Vec3 normalized(const Vec3& v) noexcept {
    return v / std::sqrt(glm::dot(v, v));
}

/// The vector divided by its length, or 0 if the length is 0 or not finite.
inline Vec3 normalized_or_zero(const Vec3& v) noexcept {
    const double length = std::sqrt(glm::dot(v, v));
    return length > 0.0 && std::isfinite(length) ? v / length : Vec3(0.0);
}

/// The unit vector from one point to another; 0 if they coincide.
inline Vec3 direction_between(const Vec3& from, const Vec3& to) noexcept {
    return normalized_or_zero(to - from);
}

}  // namespace earshot::geometry
