// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"

namespace earshot::collision {

/// The pose of one body's space in another's ("B in A"), in single precision.
struct RelativeFrame {
    float rotation[3][3];      // rotation[k][j]: component along A's axis k of B's axis j
    float abs_rotation[3][3];  // absolute values of the elements of rotation
    float translation[3];      // of B's origin
    // Bound of the rounding error of coordinates and of projections onto unit axes, metres.
    float padding;
};

/// Whether a pose is a rotation, within 1e-9, and a translation within Shape::kMaxCoordinate.
bool is_rigid(const Pose& pose) noexcept;

/// Throws Error if a pose's matrix is not a rotation or it is beyond Shape::kMaxCoordinate.
void require_rigid(const Pose& pose);

/// The relative poses of two bodies.
struct RelativePose {
    RelativeFrame b_in_a, a_in_b;
    bool is_aligned;  // both bodies have the same rotation

    /// Throws as require_rigid().
    RelativePose(const Body& a, const Body& b);
};

}  // namespace earshot::collision
