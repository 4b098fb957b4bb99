// SPDX-License-Identifier: MIT
#include "earshot/base/parallel.h"
#include "earshot/base/stage_progress.h"
#include "earshot/earshot.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/io/results.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/simulator.h"

#include <algorithm>
#include <utility>

namespace earshot {

void Room::add_source(std::string name,
                      const Vec3& position,
                      const propagation::Directivity& directivity) {
    scene.sources.push_back(
        {.name = std::move(name), .position = position, .directivity = directivity});
}

void Room::add_listener(std::string name, const Vec3& position) {
    scene.listeners.push_back({.name = std::move(name), .position = position});
}

Room load(const std::filesystem::path& file) {
    io::LoadedScene loaded = io::load_scene(file);
    return {std::move(loaded.scene), std::move(loaded.warnings)};
}

std::optional<double> Response::t30() const {
    return metrics.expected.mid.reverberation_time_t30;
}

void Response::write_wav(const std::filesystem::path& file) const {
    io::write_whole_file(file, io::encode_response(channels));
}

const Response& Responses::at(std::string_view source, std::string_view listener) const {
    const auto found = std::find_if(begin(), end(), [&](const Response& response) {
        return response.source == source && response.listener == listener;
    });
    if (found == end()) {
        std::string known;
        for (const Response& response : responses_) {
            known += (known.empty() ? "" : ", ") + response.source + " to " + response.listener;
        }
        throw Error(std::string(source) + " to " + std::string(listener),
                    "has no response",
                    "there are " + known);
    }
    return *found;
}

Responses simulate(const Room& room, const SimulationOptions& options) {
    const propagation::Scene& scene = room.scene;
    if (scene.sources.empty() || scene.listeners.empty()) {
        throw Error(
            scene.name,
            scene.sources.empty() ? "has no source" : "has no listener",
            scene.sources.empty() ? "add_source() gives it one" : "add_listener() gives it one");
    }
    propagation::ResponseFormat format = options.format;
    if (format.channels == Channels::binaural && format.hrir_set.directions.empty()) {
        format.hrir_set = io::default_hrir_set();
    }
    const propagation::Options simulation = {.specular_order = options.order,
                                             .air = options.air,
                                             .transmission = options.transmission,
                                             .rays = options.rays,
                                             .max_error = options.max_error,
                                             .seed = format.seed,
                                             .late_length = format.length,
                                             .late_directions = format.channels != Channels::mono};
    const propagation::ResponseRenderer renderer(simulation.bands, format);
    Executor executor(options.threads);
    propagation::Simulator simulator(scene, simulation, executor);
    simulator.set_time(options.time, executor);
    std::vector<propagation::PairResult> pairs = simulator.run(executor, options.progress);

    std::vector<Response> responses(pairs.size());
    StageProgress rendered(options.progress, "responses", pairs.size());
    executor.for_each(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const propagation::Emitter& listener = scene.listeners[pairs[i].listener];
            auto response =
                renderer.render(pairs[i], scene.pose_at(listener, options.time), executor);
            responses[i] = {.source = scene.sources[pairs[i].source].name,
                            .listener = listener.name,
                            .paths = std::move(pairs[i].paths),
                            .channels = std::move(response.channels),
                            .metrics = std::move(response.metrics)};
            rendered.add(1);
        }
    });
    return Responses(std::move(responses));
}

}  // namespace earshot
