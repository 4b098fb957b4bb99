// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/scene.h"

#include <vector>

namespace earshot::propagation {

/// Where something that moves is at an instant.
struct TrajectoryKey {
    double time = 0.0;  ///< seconds
    geometry::Vec3 position{0.0};
};

/// Position and velocity at an instant.
struct Motion {
    geometry::Vec3 position{0.0};
    geometry::Vec3 velocity{0.0};  ///< metres per second
};

/// The way of a source or a listener: a cubic from key to key, whose velocity at a key is that of
/// the parabola through it and its neighbours. So the velocity has no jumps, and motion at constant
/// velocity or acceleration is kept as it is. Held before the first key and after the last.
class Trajectory {
public:
    /// Of something that stays.
    explicit Trajectory(const geometry::Vec3& position);
    /// Throws Error if there is no key, times do not ascend, or a number is not finite.
    explicit Trajectory(std::vector<TrajectoryKey> keys);

    Motion at(double time) const noexcept;
    /// An upper bound of the speed, metres per second.
    double max_speed() const noexcept;

private:
    std::vector<TrajectoryKey> keys_;
    std::vector<geometry::Vec3> velocities_;  // per key
};

/// The way of an emitter of the scene from `begin` to `end` (seconds), looked up every millisecond.
Trajectory trajectory_of(const Scene& scene, const Emitter& emitter, double begin, double end);

}  // namespace earshot::propagation
