// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/simulator.h"
#include "earshot/propagation/trajectory.h"

#include <cstddef>
#include <optional>
#include <span>

namespace earshot::propagation {

/// A pair whose source plays a recording while it, the listener or the scene moves.
struct MovingPair {
    std::size_t source = 0;    ///< index into Scene::sources
    std::size_t listener = 0;  ///< index into Scene::listeners
    /// In place of where the scene has them.
    std::optional<Trajectory> source_path{}, listener_path{};
    double start = 0.0;      ///< seconds of the scene's time at which the recording begins
    double step = 0.05;      ///< seconds between the instants at which paths are found, > 0
    double late_step = 0.5;  ///< likewise for late sound
};

/// What was rendered.
struct MovingSound {
    audio::Signal signal{};    ///< sample 0 is heard at MovingPair::start
    std::size_t instants = 0;  ///< at which paths were found
    std::size_t paths = 0;     ///< paths, each counted once however long it lasts
    std::size_t late_instants = 0;
};

/// What the listener hears of a mono recording at ResponseFormat::sample_rate: every path is a
/// delay that changes with its length, so that motion is heard at the frequencies and levels of
/// p(t) = s(t_e) / r, t = t_e + r / c, r being the length from where the source was at t_e to where
/// the listener is at t. Paths that begin or end between two instants fade. Late sound is that of
/// instants late_step apart, cross-faded, whose noise stays the same. The result depends on the
/// number of threads in no bit. Throws Error if a step is not positive, the source or the listener
/// moves at more than 0.9 of the speed of sound, and as Simulator and ResponseRenderer.
/// Reports the stages "tracing", "late rays" and "sound".
MovingSound render_moving_pair(const Scene& scene,
                               const Options& simulation,
                               const ResponseFormat& format,
                               const MovingPair& pair,
                               std::span<const double> recording,
                               Executor& executor = Executor::serial(),
                               Progress* progress = nullptr);

}  // namespace earshot::propagation
