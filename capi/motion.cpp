// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/capi/internal/sound_object.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/sound_signal.h"
#include "earshot/propagation/moving_sound.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::capi {
namespace {

using propagation::Trajectory;

constexpr double kDefaultRaysError = 0.05;  // each fade of late sound averages two instants
constexpr double kMinStep = 1e-4, kMaxStep = 1e3;

constexpr es_motion_options kDefaults = {.struct_size = sizeof(es_motion_options),
                                         .source = 0,
                                         .listener = 0,
                                         .source_path = nullptr,
                                         .source_path_count = 0,
                                         .listener_path = nullptr,
                                         .listener_path_count = 0,
                                         .step = 0.05,
                                         .late_step = 0.5};

es_motion_options checked_motion(const es_motion_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_motion_options whole =
        require_struct(*options, kDefaults, sizeof(es_motion_options), "motion");
    require_in(whole.step, kMinStep, kMaxStep, "motion->step");
    require_in(whole.late_step, kMinStep, kMaxStep, "motion->late_step");
    return whole;
}

/// Nothing for null.
std::optional<Trajectory> trajectory_of(const double* path,
                                        std::size_t count,
                                        const char* argument) {
    if (path == nullptr && count == 0) {
        return std::nullopt;
    }
    static_cast<void>(require_array(path, count, argument));
    const auto numbers = require_array(path, 4 * count, argument);
    std::vector<propagation::TrajectoryKey> keys;
    for (std::size_t i = 0; i < count; ++i) {
        require_time(numbers[4 * i], argument);
        keys.push_back({numbers[4 * i], require_point(&numbers[4 * i + 1], argument)});
        if (i > 0 && !(keys[i - 1].time < keys[i].time)) {
            fail_argument(argument, "has times that do not ascend", "sort it by time");
        }
    }
    if (keys.empty()) {
        fail_argument(argument, "is empty", "give null, or at least one time and place");
    }
    return Trajectory(std::move(keys));
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_motion_options_init(es_motion_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_motion_options)); });
}

es_status es_auralize_moving(es_scene scene,
                             es_sound dry,
                             const es_simulation_options* simulation,
                             const es_motion_options* motion,
                             es_sound* wet) {
    return call(__func__, [&] {
        const Reading<SceneObject> scene_object(scene, "scene");
        const Reading<SoundObject> sound_object(dry, "dry");
        require(wet, "wet");
        const propagation::Scene& contents = scene_object->loaded.scene;
        const es_simulation_options given = checked_options_or(simulation, kDefaultRaysError);
        const es_motion_options moved = checked_motion(motion);
        require_index(moved.source, contents.sources.size(), "motion->source");
        require_index(moved.listener, contents.listeners.size(), "motion->listener");
        const audio::Signal recording = mono_recording(*sound_object);
        propagation::ResponseFormat format = response_format(given);
        format.sample_rate = static_cast<double>(recording.sample_rate);
        const propagation::MovingPair pair = {
            .source = moved.source,
            .listener = moved.listener,
            .source_path =
                trajectory_of(moved.source_path, moved.source_path_count, "motion->source_path"),
            .listener_path = trajectory_of(
                moved.listener_path, moved.listener_path_count, "motion->listener_path"),
            .start = given.time,
            .step = moved.step,
            .late_step = moved.late_step};
        Executor executor(given.threads);
        CallbackProgress progress(given.progress, given.progress_data);
        const propagation::MovingSound sound =
            propagation::render_moving_pair(contents,
                                            simulator_options(given),
                                            format,
                                            pair,
                                            recording.channels.front(),
                                            executor,
                                            &progress);
        *wet = publish(std::make_shared<SoundObject>(io::sound_of(sound.signal)));
    });
}
