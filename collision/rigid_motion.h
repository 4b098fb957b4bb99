// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::collision {

/// A screw motion: a rotation about an axis and a translation along it, both at a constant rate
/// from time 0 to 1. There is one between any two rigid poses (Chasles 1830). With one of the two 0
/// it is a revolute or a prismatic joint.
struct Screw {
    geometry::Vec3 point{0.0};           ///< on the axis, metres
    geometry::Vec3 axis{0.0, 1.0, 0.0};  ///< unit length
    double angle = 0.0;                  ///< radians, right-handed; whole turns count
    double slide = 0.0;                  ///< metres

    /// The screw from `from` to `to` with a rotation by half a circle at most. Throws Error if a
    /// pose is not rigid (rotations may be off by 1e-9).
    static Screw between(const Pose& from, const Pose& to);

    /// The displacement from time 0 to `time`.
    Pose at(double time) const noexcept;

    /// Where a point that is at `p` at time 0 is at `time`: the displacement is summed up by
    /// itself, so an axis that is far away costs no digits.
    geometry::Vec3 apply(const geometry::Vec3& p, double time) const noexcept;

    /// An upper bound of how far the path of a point from `p` deviates from its chord, metres:
    /// r angle^2 / 8 at the distance r from the axis. Over a part of the time its square of that.
    double chord_deviation(const geometry::Vec3& p) const noexcept;

    friend bool operator==(const Screw&, const Screw&) = default;
};

/// A rigid motion from time 0 to 1: a kinematic chain of screws, each fixed to the one before and
/// all at once, moves a body that begins in `start`, as the joints of an arm do from its base to
/// its hand. Without screws the body rests.
struct RigidMotion {
    Pose start{};
    std::vector<Screw> screws{};

    Pose at(double time) const noexcept;

    /// An upper bound of the acceleration of any of the points, metres per square of the time of
    /// the whole motion: a rotation at rate w of points with speed v and acceleration a, at most r
    /// from the axis, gives w^2 r + 2 w v + a.
    double acceleration_bound(std::span<const geometry::Vec3> points) const noexcept;
};

/// How many linear steps of equal duration stay within `tolerance` metres (> 0) of a path of
/// bounded acceleration a: the chord of a step of duration h deviates by at most a h^2 / 8. At
/// least 1; infinite if that is beyond doubles.
double linear_step_count(double acceleration_bound, double tolerance) noexcept;

}  // namespace earshot::collision
