// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/simulation.h"

#include "earshot/base/stage_progress.h"
#include "earshot/capi/internal/bands.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/propagation/channel_count.h"
#include "earshot/propagation/decay_notes.h"
#include "earshot/propagation/pair_notes.h"

#include <algorithm>
#include <string>

namespace earshot::capi {
namespace {

using propagation::PairResult;
using propagation::Scene;

/// What results tell of a scene: names and materials.
Scene names_of(const Scene& scene) {
    Scene names;
    names.name = scene.name;
    for (const propagation::Emitter& source : scene.sources) {
        names.sources.push_back({.name = source.name});
    }
    for (const propagation::Emitter& listener : scene.listeners) {
        names.listeners.push_back({.name = listener.name});
    }
    names.materials = scene.materials;
    return names;
}

/// Pairs without sound, and where the rays did not suffice for the error that was asked for.
void add_notes(ResultObject& result) {
    for (const PairResult& pair : result.pairs) {
        const std::string name = result.names.sources[pair.source].name + " to " +
                                 result.names.listeners[pair.listener].name;
        const Warnings notes = propagation::note_sound(pair, name);
        result.notes.insert(result.notes.end(), notes.begin(), notes.end());
    }
}

/// The channels of a pair as floats, one after the other.
std::vector<float> floats_of(const std::vector<audio::ImpulseResponse>& channels) {
    std::vector<float> floats;
    for (const audio::ImpulseResponse& channel : channels) {
        for (const double sample : channel.samples) {
            floats.push_back(static_cast<float>(sample));
        }
    }
    return floats;
}

/// Joins the pairs' channels to one block, shorter ones padded with zeros.
void join(const std::vector<std::vector<float>>& of_pairs,
          std::size_t channels,
          ResultObject& result) {
    std::size_t samples = 0;
    for (const std::vector<float>& floats : of_pairs) {
        result.lengths.push_back(floats.size() / channels);
        samples = std::max(samples, floats.size() / channels);
    }
    result.info.samples = samples;
    result.responses.resize(of_pairs.size() * channels * samples);
    float* out = result.responses.data();
    for (std::size_t pair = 0; pair < of_pairs.size(); ++pair) {
        const std::size_t length = result.lengths[pair];
        for (std::size_t channel = 0; channel < channels; ++channel) {
            std::copy_n(of_pairs[pair].data() + channel * length, length, out);
            out += samples;
        }
    }
}

}  // namespace

Simulation::Simulation(const es_simulation_options* options)
    : given_(checked_options(options)),
      visible_sets_(given_.visible_sets == 0
                        ? nullptr
                        : std::static_pointer_cast<VisibleSetsObject>(object_of(
                              given_.visible_sets, ES_KIND_VISIBLE_SETS, "options->visible_sets"))),
      options_(simulator_options(given_)),
      format_(response_format(given_)) {
    if (visible_sets_ != nullptr) {
        options_.visible_sets = &visible_sets_->sets;
    }
    if (given_.responses != 0 || given_.metrics != 0 || given_.sofa != 0) {
        renderer_.emplace(options_.bands, format_);
    }
}

std::shared_ptr<ResultObject> Simulation::run(propagation::Simulator& simulator,
                                              const Scene& scene,
                                              double time,
                                              Executor& executor,
                                              Progress& progress) const {
    auto result = std::make_shared<ResultObject>();
    result->names = names_of(scene);
    result->bands = options_.bands;
    result->speech = format_.speech;
    result->channels = format_.channels;
    simulator.set_time(time, executor);
    result->pairs = simulator.run(executor, &progress);
    for (const PairResult& pair : result->pairs) {
        result->listener_poses.push_back(scene.pose_at(scene.listeners[pair.listener], time));
    }
    result->info = {
        .struct_size = 0,
        .sources = scene.sources.size(),
        .listeners = scene.listeners.size(),
        .channels = propagation::channel_count(format_.channels, format_.ambisonic_order),
        .samples = 0,
        .bands = options_.bands.count(),
        .paths = 0,
        .sample_rate = format_.sample_rate,
        .time = time,
        .speed_of_sound = propagation::speed_of_sound(options_.air),
        .triangles = simulator.geometry().triangles,
        .facets = simulator.geometry().facets,
        .frusta = simulator.statistics().frusta};
    add_notes(*result);
    if (options_.diffraction == 0) {
        const Warnings notes = propagation::note_blocked_pairs(result->names, result->pairs);
        result->notes.insert(result->notes.end(), notes.begin(), notes.end());
    }
    if (renderer_) {
        render(scene, time, *result, executor, progress);
    }
    if (given_.metrics != 0) {
        describe_room(simulator, scene, time, *result, executor);
    }
    if (given_.sensitivity != 0) {
        describe_materials(scene, time, *result, executor);
    }
    result->has_paths = given_.paths != 0;
    result->has_histograms = given_.histograms != 0;
    for (PairResult& pair : result->pairs) {
        pair.late_replicates = {};
        pair.late_materials = {};
        if (!result->has_histograms) {
            pair.late = {.bin = pair.late.bin, .full_decay = pair.late.full_decay};
        }
    }
    result->finish();
    return result;
}

void Simulation::render(const Scene& scene,
                        double time,
                        ResultObject& result,
                        Executor& executor,
                        Progress& progress) const {
    const std::vector<PairResult>& pairs = result.pairs;
    std::vector<std::vector<float>> floats(pairs.size());
    result.metrics.resize(given_.metrics != 0 ? pairs.size() : 0);
    result.measurements.resize(given_.sofa != 0 ? pairs.size() : 0);
    StageProgress rendered(&progress, "responses", pairs.size());
    executor.for_each(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const propagation::Emitter& listener = scene.listeners[pairs[i].listener];
            propagation::Response response =
                renderer_->render(pairs[i], scene.pose_at(listener, time), executor);
            if (given_.metrics != 0) {
                result.metrics[i] = std::move(response.metrics);
            }
            if (given_.responses != 0) {
                floats[i] = floats_of(response.channels);
            }
            if (given_.sofa != 0) {
                result.measurements[i] = {
                    .source = scene.pose_at(scene.sources[pairs[i].source], time),
                    .listener = scene.pose_at(listener, time),
                    .channels = std::move(response.channels)};
            }
            rendered.add(1);
        }
    });
    if (given_.responses != 0) {
        join(floats, result.info.channels, result);
    }
}

void Simulation::describe_room(const propagation::Simulator& simulator,
                               const Scene& scene,
                               double time,
                               ResultObject& result,
                               Executor& executor) const {
    std::vector<geometry::Vec3> sources;
    for (const propagation::Emitter& source : scene.sources) {
        sources.push_back(scene.pose_at(source, time).position);
    }
    const propagation::RoomStatisticsOptions options = {
        .bands = options_.bands, .air = options_.air, .air_absorption = options_.air_absorption};
    result.room = propagation::room_statistics(simulator.ray_scene(), sources, options, executor);
    if (result.room) {
        const Warnings notes = propagation::explain_long_decays(
            simulator, scene, *result.room, options, result.metrics, executor);
        result.notes.insert(result.notes.end(), notes.begin(), notes.end());
    }
}

void Simulation::describe_materials(const Scene& scene,
                                    double time,
                                    ResultObject& result,
                                    Executor& executor) const {
    result.material_areas = propagation::material_areas(scene, time);
    result.sensitivity.resize(result.pairs.size());
    executor.for_each(result.pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            result.sensitivity[i] = propagation::pair_sensitivity(
                scene, result.pairs[i], {.bands = options_.bands, .speech = format_.speech});
        }
    });
}

void require_emitters(const Scene& scene) {
    for (const auto& [emitters, role] :
         {std::pair(&scene.sources, "source"), std::pair(&scene.listeners, "listener")}) {
        if (emitters->empty()) {
            throw Error(
                scene.name, std::string("the scene has no ") + role, "es_scene_add() gives it one");
        }
    }
}

}  // namespace earshot::capi
