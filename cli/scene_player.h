// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/progress.h"
#include "earshot/cli/way_options.h"
#include "earshot/propagation/engine/engine.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace earshot::cli {

/// What the sources of a scene play while they and its listener move.
struct Programme {
    propagation::Scene scene{};  ///< with one listener
    Ways ways{};
    double start = 0.0;  ///< seconds of the scene's time
    /// By source, at the engine's sample rate; empty: silence.
    std::vector<std::vector<float>> recordings{};
    std::size_t frames = 0;  ///< to be heard
};

/// Gives a programme to a real-time engine, block by block (propagation/engine/engine.h).
class ScenePlayer {
public:
    /// Throws Error as the engine.
    ScenePlayer(Programme programme,
                const propagation::EngineOptions& options,
                Executor& executor = Executor::serial());

    /// Renders into memory, from the start on: paths are found at intervals of the sound, so that
    /// the samples do not depend on how fast the machine is.
    audio::Signal render(Progress& progress);

    /// Plays through an audio device, while the engine's own thread finds the paths. Returns how
    /// often samples came too late.
    std::uint64_t play(const std::string& device, Progress& progress);

    propagation::EngineStatistics statistics() const { return engine_.statistics(); }

private:
    void publish(std::size_t frame);
    void render_block(float* const* outputs, std::size_t frames) noexcept;

    Programme programme_;
    propagation::Engine engine_;
    std::vector<const float*> inputs_;  // per source
    std::size_t position_ = 0;          // in the recordings
};

}  // namespace earshot::cli
