// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/moving_paths.h"
#include "earshot/propagation/trajectory.h"
#include "earshot/propagation/unfolded_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::propagation {

/// As MovingPaths::receive(); `unfolded_at` gives the MovingUnfoldedPath for sound emitted at a
/// time.
template <typename UnfoldedAt>
PathReception receive_path(const UnfoldedAt& unfolded_at,
                           const Trajectory& source,
                           const Motion& listener,
                           double time,
                           double speed_of_sound,
                           double near) {
    // What arrives is later than `time` by this, which grows with the emission: Newton's method,
    // kept between bounds that close in.
    constexpr int kMaxSteps = 60;
    constexpr double kTolerance = 1e-13;  // seconds
    double low = -std::numeric_limits<double>::infinity();
    double high = time;
    double emission = std::min(near, time);
    MovingLength at;
    for (int step = 0; step < kMaxSteps; ++step) {
        at = length_of(unfolded_at(emission), source.at(emission), listener);
        const double late = emission + at.length / speed_of_sound - time;
        (late > 0.0 ? high : low) = emission;
        double next = emission - late / (1.0 + at.rate_by_source / speed_of_sound);
        if (!(next > low && next < high)) {
            next = std::isfinite(low) ? 0.5 * (low + high) : emission - 2.0 * late;
        }
        const double change = std::abs(next - emission);
        emission = next;
        if (change <= kTolerance) {
            break;
        }
    }
    at = length_of(unfolded_at(emission), source.at(emission), listener);
    // The derivative of emission + length / c = time by the time.
    const double emission_rate =
        (1.0 - at.rate_by_listener / speed_of_sound) / (1.0 + at.rate_by_source / speed_of_sound);
    return {.emission = emission,
            .delay = at.length / speed_of_sound,
            .delay_rate = 1.0 - emission_rate,
            .arrival = at.arrival};
}

}  // namespace earshot::propagation
