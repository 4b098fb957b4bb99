// SPDX-License-Identifier: MIT
// Recordings played over paths that have been found already.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/result_object.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/capi/internal/sound_object.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/path_frames.h"
#include "earshot/io/sound_signal.h"
#include "earshot/propagation/path_frames.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace earshot::capi {
namespace {

using propagation::PathFrames;

void require_agreement(const ResultObject& result,
                       const PathFrames& frames,
                       const std::string& argument) {
    if (!frames.instants.empty() && (result.bands.count() != frames.bands.count() ||
                                     result.info.speed_of_sound != frames.speed_of_sound)) {
        fail_argument(argument,
                      "differs from the first in its bands or its speed of sound",
                      "give results of the same options");
    }
    if (!frames.instants.empty() && !(frames.instants.back().time < result.info.time)) {
        fail_argument(argument, "is not later than the one before it", "sort results by time");
    }
}

/// Adds the paths of a pair of the result.
void add_instant(const ResultObject& result,
                 std::uint32_t source,
                 std::uint32_t listener,
                 const std::string& argument,
                 PathFrames& frames) {
    require_index(source, result.info.sources, "source");
    require_index(listener, result.info.listeners, "listener");
    require_paths(result);
    require_agreement(result, frames, argument);
    frames.bands = result.bands;
    frames.speed_of_sound = result.info.speed_of_sound;
    const std::size_t pair = result.pair_index(source, listener);
    frames.instants.push_back({.time = result.info.time,
                               .paths = result.pairs[pair].paths,
                               .listener_front = result.listener_poses[pair].front,
                               .listener_up = result.listener_poses[pair].up});
}

es_sound rendered(const PathFrames& frames,
                  const audio::Signal& recording,
                  const es_simulation_options& given) {
    propagation::ResponseFormat format = response_format(given);
    format.sample_rate = static_cast<double>(recording.sample_rate);
    Executor executor(given.threads);
    CallbackProgress progress(given.progress, given.progress_data);
    const propagation::MovingSound sound = propagation::render_path_frames(
        frames, format, recording.channels.front(), executor, &progress);
    return publish(std::make_shared<SoundObject>(io::sound_of(sound.signal)));
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_auralize_paths(const char* paths,
                            const char* source,
                            const char* listener,
                            es_sound dry,
                            const es_simulation_options* simulation,
                            es_sound* wet) {
    return call(__func__, [&] {
        const std::string file(require_text(paths, "paths"));
        const io::PairNames names = {.source = std::string(text_or(source, "", "source")),
                                     .listener = std::string(text_or(listener, "", "listener"))};
        const Reading<SoundObject> sound_object(dry, "dry");
        require(wet, "wet");
        const es_simulation_options given = checked_options(simulation);
        const audio::Signal recording = mono_recording(*sound_object);
        const std::vector<io::PairPathFrames> pairs = io::read_path_frames(file);
        *wet = rendered(io::frames_of_pair(pairs, names), recording, given);
    });
}

es_status es_auralize_results(const es_result* results,
                              size_t count,
                              uint32_t source,
                              uint32_t listener,
                              es_sound dry,
                              const es_simulation_options* simulation,
                              es_sound* wet) {
    return call(__func__, [&] {
        constexpr std::size_t kMaxResults = std::size_t{1} << 24U;
        require_count(count, 2, kMaxResults, "count");
        const auto handles = require_array(results, count, "results");
        const Reading<SoundObject> sound_object(dry, "dry");
        require(wet, "wet");
        const es_simulation_options given = checked_options(simulation);
        const audio::Signal recording = mono_recording(*sound_object);
        PathFrames frames{.name = "results"};
        for (std::size_t i = 0; i < count; ++i) {
            const std::string argument = "results[" + std::to_string(i) + "]";
            const Reading<ResultObject> result(handles[i], argument.c_str());
            add_instant(*result, source, listener, argument, frames);
        }
        *wet = rendered(frames, recording, given);
    });
}
