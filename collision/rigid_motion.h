// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::collision {

/// A turn about an axis and a slide along it, both at a constant rate from time 0 to 1: what every
/// rigid motion from one pose to another can be (Chasles 1830). With one of the two 0, a joint that
/// turns or one that slides.
struct Screw {
    geometry::Vec3 point{0.0};           ///< on the axis, metres
    geometry::Vec3 axis{0.0, 1.0, 0.0};  ///< unit length
    double angle = 0.0;                  ///< radians, right-handed; whole turns count
    double slide = 0.0;                  ///< metres

    /// Takes `from` to `to` with a turn of half a circle at most. Throws Error if a pose is not
    /// rigid (rotations may be off by 1e-9).
    static Screw between(const Pose& from, const Pose& to);

    /// What moves a point from where it is at time 0 to where it is at `time`.
    Pose at(double time) const noexcept;
};

/// How something rigid moves from time 0 to 1: it stands in `start`, and screws, each fixed to the
/// one before, move it at once: the joints of an arm from its foot to its hand. Without screws it
/// rests.
struct RigidMotion {
    Pose start{};
    std::vector<Screw> screws{};

    Pose at(double time) const noexcept;

    /// A bound of how fast any of the points changes its velocity, metres per square of the time of
    /// the whole motion: of a turn at rate w of what moves at speed v and acceleration a, at most r
    /// from the axis, w^2 r + 2 w v + a.
    double acceleration_bound(std::span<const geometry::Vec3> points) const noexcept;
};

/// How many straight steps of equal times stay within `tolerance` metres (> 0) of a path at all
/// times, if its acceleration is bounded: chords of a step of time h stray by at most a h^2 / 8. At
/// least 1; infinite if that is beyond doubles.
double linear_step_count(double acceleration_bound, double tolerance) noexcept;

}  // namespace earshot::collision
