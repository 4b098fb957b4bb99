// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/trajectory.h"

#include <vector>

namespace earshot::propagation {

/// Where an emitter has been lately, by the time at which it was published.
class EmitterHistory {
public:
    /// `seconds`: how far back it is asked for. `max_speed`: faster, an emitter has not moved but
    /// jumped.
    EmitterHistory(double seconds, double max_speed) : seconds_(seconds), max_speed_(max_speed) {}

    /// Adds where it is at a time, which is not before the last. False if it has jumped there: then
    /// it has never been elsewhere.
    bool add(double time, const geometry::Vec3& position);

    const Trajectory& trajectory() const noexcept { return trajectory_; }
    /// At the last time.
    Motion motion() const noexcept;

private:
    double seconds_, max_speed_;
    std::vector<TrajectoryKey> keys_;
    Trajectory trajectory_{geometry::Vec3(0.0)};
};

}  // namespace earshot::propagation
