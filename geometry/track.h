// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::geometry {

/// Translation, rotation, scale of a node relative to its parent, as in glTF 2.0 section 3.5.3.
struct Transform {
    Vec3 translation{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z; unit length
    Vec3 scale{1.0};

    /// Scale first, then rotate, then translate. Exact where the parts are the identity.
    glm::dmat4 matrix() const noexcept;
};

/// The point moved by an affine matrix (its bottom row is taken as 0, 0, 0, 1).
Vec3 transform_point(const glm::dmat4& matrix, const Vec3& point) noexcept;

/// Along the shorter great arc from `a` (at 0) to `b` (at 1), both of unit length; the result is of
/// unit length. glTF 2.0 appendix C.4, with the angle from atan2 so that near and opposite
/// rotations need no threshold.
glm::dquat slerp(const glm::dquat& a, const glm::dquat& b, double fraction) noexcept;

enum class Interpolation { step, linear, cubic_spline };

/// Key frames of one property (glTF 2.0 section 3.11). `values` holds the property's numbers per
/// key, or three times as many for cubic_spline (in-tangent, value, out-tangent). No keys: not
/// animated.
struct Track {
    Interpolation interpolation = Interpolation::linear;
    std::vector<double> times;  ///< seconds, strictly ascending
    std::vector<double> values;

    bool is_empty() const noexcept { return times.empty(); }

    /// The value at `t` (glTF 2.0 appendix C), held before the first and after the last key.
    /// Rotations (x, y, z, w) are interpolated along the shorter great arc and normalised.
    /// Preconditions: not empty; `out` has the property's width, 4 for a rotation.
    void sample(double t, std::span<double> out, bool is_rotation) const;
};

}  // namespace earshot::geometry
