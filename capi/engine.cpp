// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/engine_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation_options.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace earshot::capi {
namespace {

using geometry::Vec3;
using propagation::Engine;
using propagation::Pose;

constexpr std::int64_t kMaxRays = 1000000;

constexpr es_engine_options kDefaults = {.struct_size = sizeof(es_engine_options),
                                         .order = 3,
                                         .rays = 2000,
                                         .block = 256,
                                         .any_frame_count = 0,
                                         .motion_delay = 0.1,
                                         .max_delay = 1.0,
                                         .max_paths = 512,
                                         .max_filters = 24,
                                         .late_length = 0.0,
                                         .update_interval = 0.05,
                                         .budget_milliseconds = 0.0,
                                         .budget_work = 0};

es_engine_options checked_engine_options(const es_engine_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_engine_options whole =
        require_struct(*options, kDefaults, sizeof(es_engine_options), "options");
    require_in(std::int64_t{whole.order}, 0, 64, "options->order");
    require_in(std::int64_t{whole.rays}, 0, kMaxRays, "options->rays");
    require_in(std::int64_t{whole.block}, 32, 4096, "options->block");
    if (!std::has_single_bit(whole.block)) {
        fail_argument("options->block",
                      "is " + std::to_string(whole.block) + ", which is no power of two",
                      "256 is usual");
    }
    require_flag(whole.any_frame_count, "options->any_frame_count");
    require_in(whole.motion_delay, 0.0, 10.0, "options->motion_delay");
    require_in(whole.max_delay, 1e-3, 10.0, "options->max_delay");
    require_in(std::int64_t{whole.max_paths}, 1, 65536, "options->max_paths");
    require_in(std::int64_t{whole.max_filters}, 1, 64, "options->max_filters");
    require_in(whole.late_length, 0.0, 20.0, "options->late_length");
    require_in(whole.update_interval, 0.0, 60.0, "options->update_interval");
    require_in(whole.budget_milliseconds, 0.0, 1e9, "options->budget_milliseconds");
    return whole;
}

propagation::EngineOptions engine_options(const es_simulation_options& simulation,
                                          const es_engine_options& given) {
    propagation::EngineOptions options;
    options.simulation = simulator_options(simulation);
    options.simulation.specular_order = given.order;
    options.simulation.rays = given.rays;
    const propagation::ResponseFormat format = response_format(simulation);
    options.channels = format.channels;
    options.ambisonic_order = format.ambisonic_order;
    options.hrir_set = format.hrir_set;
    options.sample_rate = format.sample_rate;
    options.start_time = simulation.time;
    options.seed = format.seed;
    options.block = given.block;
    options.any_frame_count = given.any_frame_count != 0;
    options.motion_delay = given.motion_delay;
    options.max_delay = given.max_delay;
    options.max_paths = given.max_paths;
    options.max_filters = given.max_filters;
    options.late_length = given.late_length;
    options.update_interval = given.update_interval;
    options.budget = {.milliseconds = given.budget_milliseconds, .work = given.budget_work};
    return options;
}

/// Two ears, from a sound field of order 3, where the caller says nothing.
es_simulation_options checked_simulation(const es_simulation_options* simulation) {
    es_simulation_options whole = checked_options(simulation);
    if (simulation == nullptr) {
        whole.format = ES_FORMAT_BINAURAL;
        whole.ambisonic_order = 3;
    }
    return whole;
}

Pose pose_of(const Vec3& position, const double* front, const double* up) {
    const Vec3 ahead = front == nullptr ? Vec3(0.0, 0.0, -1.0) : require_point(front, "front");
    const Vec3 above = up == nullptr ? Vec3(0.0, 1.0, 0.0) : require_point(up, "up");
    if (!(glm::length(ahead) > 0.0)) {
        fail_argument("front", "has no length", "give a direction");
    }
    return propagation::pose_towards(position, ahead, above);
}

const Vec3& vector_at(const double* numbers) {
    return *reinterpret_cast<const Vec3*>(numbers);
}

/// Held while a call renders.
class RenderTurn {
public:
    explicit RenderTurn(std::atomic<bool>& is_rendering) : is_rendering_(is_rendering) {
        if (is_rendering_.exchange(true, std::memory_order_acquire)) {
            fail_busy(ES_KIND_ENGINE, "engine");
        }
    }
    ~RenderTurn() { is_rendering_.store(false, std::memory_order_release); }
    RenderTurn(const RenderTurn&) = delete;
    RenderTurn& operator=(const RenderTurn&) = delete;

private:
    std::atomic<bool>& is_rendering_;
};

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_engine_options_init(es_engine_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_engine_options)); });
}

es_status es_engine_create(es_scene scene,
                           const es_simulation_options* simulation,
                           const es_engine_options* options,
                           es_engine* engine) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(engine, "engine");
        const es_simulation_options given = checked_simulation(simulation);
        const es_engine_options whole = checked_engine_options(options);
        if (given.visible_sets != 0) {
            fail_argument("simulation->visible_sets", "is given", "engines have none");
        }
        *engine = publish(std::make_shared<EngineObject>(
            object->loaded.scene, engine_options(given, whole), given.threads));
    });
}

es_status es_engine_get_info(es_engine engine, es_engine_info* info) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const Engine& played = object->engine;
        give_struct({.struct_size = sizeof(es_engine_info),
                     .sources = played.sources(),
                     .listeners = played.listeners(),
                     .channels = played.channels(),
                     .sample_rate = played.sample_rate(),
                     .block = played.options().block,
                     .latency = played.latency()},
                    info,
                    sizeof(es_engine_info),
                    "info");
    });
}

es_status es_engine_place_source(es_engine engine,
                                 size_t source,
                                 const double position[3],
                                 const double front[3]) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        require_index(source, object->engine.sources(), "source");
        const Pose pose = pose_of(require_point(position, "position"), front, nullptr);
        const std::lock_guard lock(object->control);
        object->engine.place_source(source, pose);
    });
}

es_status es_engine_place_listener(es_engine engine, size_t listener, const double position[3]) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        require_index(listener, object->engine.listeners(), "listener");
        const Vec3 place = require_point(position, "position");
        const std::lock_guard lock(object->control);
        object->engine.place_listener(listener, {.position = place});
    });
}

es_status es_engine_set_time(es_engine engine, double time) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        require_time(time, "time");
        const std::lock_guard lock(object->control);
        object->engine.set_scene_time(time);
    });
}

es_status es_engine_publish(es_engine engine) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const std::lock_guard lock(object->control);
        object->engine.publish();
    });
}

es_status es_engine_turn_listener(es_engine engine,
                                  size_t listener,
                                  const double front[3],
                                  const double up[3]) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        require_index(listener, object->engine.listeners(), "listener");
        require(front, "front");
        require(up, "up");
        const Pose pose = pose_of({}, front, up);
        object->engine.turn_listener(listener, pose);
    });
}

es_status es_engine_update(es_engine engine) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const std::unique_lock lock(object->update, std::try_to_lock);
        if (!lock.owns_lock() || object->is_started) {
            fail_busy(ES_KIND_ENGINE, "engine");
        }
        object->engine.update();
    });
}

es_status es_engine_start(es_engine engine) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const std::lock_guard lock(object->update);
        object->engine.start();
        object->is_started = true;
    });
}

es_status es_engine_stop(es_engine engine) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const std::lock_guard lock(object->update);
        object->engine.stop();
        object->is_started = false;
    });
}

es_status es_engine_render(es_engine engine, const float* inputs, size_t frames, float* outputs) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        Engine& played = object->engine;
        const std::size_t channels = played.listeners() * played.channels();
        constexpr std::size_t kMaxFrames = std::size_t{1} << 32U;
        require_count(frames, 0, kMaxFrames, "frames");
        require_array(inputs, played.sources() * frames, "inputs");
        require_array(outputs, channels * frames, "outputs");
        const std::size_t block = played.options().block;
        if (!played.options().any_frame_count && frames % block != 0) {
            fail_argument("frames",
                          "is " + std::to_string(frames) + ", which is no multiple of " +
                              std::to_string(block),
                          "set any_frame_count");
        }
        const RenderTurn turn(object->is_rendering);
        std::vector<const float*> in;
        for (std::size_t source = 0; source < played.sources(); ++source) {
            in.push_back(inputs + source * frames);
        }
        std::vector<float*> out;
        for (std::size_t channel = 0; channel < channels; ++channel) {
            out.push_back(outputs + channel * frames);
        }
        played.render(in.data(), out.data(), frames);
    });
}

es_status es_engine_renderer(es_engine engine, es_renderer** renderer) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        require(renderer, "renderer");
        *renderer = reinterpret_cast<es_renderer*>(&object->engine);
    });
}

void es_renderer_render(es_renderer* renderer,
                        const float* const* inputs,
                        float* const* outputs,
                        size_t frames) {
    reinterpret_cast<Engine*>(renderer)->render(inputs, outputs, frames);
}

void es_renderer_turn(es_renderer* renderer,
                      size_t listener,
                      const double front[3],
                      const double up[3]) {
    const Vec3& ahead = vector_at(front);
    const Vec3& above = vector_at(up);
    reinterpret_cast<Engine*>(renderer)->turn_listener(
        listener, {.front = ahead, .left = glm::cross(above, ahead), .up = above});
}

es_status es_engine_get_statistics(es_engine engine, es_engine_statistics* statistics) {
    return call(__func__, [&] {
        const Reading<EngineObject> object(engine, "engine");
        const propagation::EngineStatistics of = object->engine.statistics();
        es_engine_statistics result = {.struct_size = sizeof(es_engine_statistics),
                                       .updates = of.updates,
                                       .median_update_milliseconds = of.median_update_milliseconds,
                                       .max_update_milliseconds = of.max_update_milliseconds,
                                       .work = of.work,
                                       .paths = of.paths,
                                       .dropped_paths = of.dropped_paths,
                                       .deferred_sources = of.deferred_sources,
                                       .deferred_late = of.deferred_late,
                                       .reduced_late = of.reduced_late,
                                       .failed_updates = of.failed_updates,
                                       .max_filter_error = of.max_filter_error,
                                       .blocks = of.blocks,
                                       .late_snapshots = of.late_snapshots,
                                       .refused_calls = of.refused_calls,
                                       .load = {}};
        static_assert(std::size(decltype(result.load){}) ==
                      propagation::EngineStatistics::kLoadSteps + 1);
        std::copy(of.load.begin(), of.load.end(), result.load);
        give_struct(result, statistics, sizeof(es_engine_statistics), "statistics");
    });
}
