// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_bank.h"
#include "earshot/audio/hrir_interpolator.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/spatial.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/moving_paths.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/trajectory.h"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A pair in motion, as its early sound is rendered.
struct MovingEarlySound {
    const MovingPaths& paths;
    const Trajectory& source;
    const Trajectory& listener;
    /// How the listener is turned at a time.
    std::function<audio::Orientation(double)> orientation_at;
    const ResponseFormat& format;
    const std::optional<audio::HrirInterpolator>& hrirs;  ///< of a binaural format
    const audio::Assembler& assembler;                    ///< of the format's sample rate
    double speed_of_sound = 343.2;
    double start = 0.0;  ///< seconds, the time of the recording's first sample
};

/// What arrives over the paths of a recording, per channel, until the last sound has.
std::vector<std::vector<double>> render_early_sound(const MovingEarlySound& sound,
                                                    std::span<const double> recording,
                                                    Executor& executor,
                                                    Progress* progress);

}  // namespace earshot::propagation
