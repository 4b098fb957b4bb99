// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"

namespace earshot::collision {

/// How boxes of one body's space, the guest's, lie in another's, in single precision.
struct GuestFrame {
    float turn[3][3];       // turn[k][j]: coordinate k of the guest's axis j
    float magnitude[3][3];  // of turn's elements
    float origin[3];
    // What all coordinates, and distances along axes of a length up to 1, may be off, metres.
    float padding;
};

/// Throws Error if a pose turns by no rotation or is beyond Shape::kMaxCoordinate.
void require_rigid(const Pose& pose);

/// Two bodies' spaces as seen from each other.
struct RelativePose {
    GuestFrame b_in_a, a_in_b;
    bool is_aligned;  // neither is turned against the other

    /// Throws as require_rigid().
    RelativePose(const Body& a, const Body& b);
};

}  // namespace earshot::collision
