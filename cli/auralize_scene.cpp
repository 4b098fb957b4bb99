// SPDX-License-Identifier: MIT
#include "earshot/cli/auralize_scene.h"

#include "earshot/cli/recording.h"

#include <cstddef>
#include <utility>

namespace earshot::cli {

using propagation::Emitter;

// Late sound is traced at many instants, and each of its fades averages two of them.
AuralizeScene::AuralizeScene()
    : simulation_choice_({.order = 4, .rays_error_percent = 5.0, .max_auto_rays = 100000}) {}

void AuralizeScene::add_to(CLI::App& app) {
    app.add_option("--scene",
                   file_,
                   "in place of responses: a scene in which DRY is played while it, sources or the "
                   "listener move")
        ->type_name("SCENE");
    app.add_option("--from", from_, "name of the source that plays DRY, if there are several")
        ->type_name("NAME");
    app.add_option("--to", to_, "name of the listener that hears it, if there are several")
        ->type_name("NAME");
    ways_.add_to(app);
    add_number(app,
               "--step",
               step_,
               {1e-4, 1e3},
               "seconds between the instants at which paths are found; those that come or go fade "
               "for as long; default: 0.05");
    add_number(app,
               "--late-step",
               late_step_,
               {1e-3, 1e3},
               "seconds between the instants at which late sound is traced; default: 0.5");
    scene_choice_.add_reading_to(app);
    emitters_.add_to(app);
    materials_.add_to(app);
    simulation_choice_.add_to(app);
    add_integer(app,
                "--diffraction",
                diffraction_,
                {0, 1},
                "maximum number of edges that a path bends round, beside its reflections");
    format_choice_.add_to(app);
}

void AuralizeScene::load(const CLI::App& app, std::int64_t seed) {
    scene_choice_.set_file(file_);
    start_ = scene_choice_.times(app).front();
    simulation_ = simulation_choice_.options(app, seed);
    simulation_.diffraction = static_cast<int>(diffraction_);
    format_.seed = static_cast<std::uint64_t>(seed);
    format_choice_.apply(app, format_);
    io::LoadedScene loaded = scene_choice_.load();
    materials_.apply(file_, loaded);
    emitters_.apply(app, scene_choice_, loaded.scene);
    warnings_ = loaded.warnings;
    const Warnings acoustic = io::warnings_of_acoustics(loaded);
    warnings_.insert(warnings_.end(), acoustic.begin(), acoustic.end());
    scene_ = std::move(loaded.scene);
    trajectories_ = ways_.read(app, scene_choice_, scene_);
}

propagation::MovingSound AuralizeScene::play(const std::string& source,
                                             const std::string& recording_name,
                                             const audio::Signal& recording,
                                             Executor& executor,
                                             Progress& progress) const {
    require_mono(recording_name, recording);
    const std::string& name = source.empty() ? from_ : source;
    propagation::MovingPair pair{
        .source = find_emitter(
            file_, scene_.sources, {.role = "source", .option = "--from", .name = name}),
        .listener = find_emitter(
            file_, scene_.listeners, {.role = "listener", .option = "--to", .name = to_}),
        .start = start_,
        .step = step_,
        .late_step = late_step_};
    const auto way_of = [&](const Emitter& emitter) {
        const auto way = trajectories_.find(emitter.name);
        return way == trajectories_.end() ? std::nullopt : std::optional(way->second);
    };
    pair.source_path = way_of(scene_.sources[pair.source]);
    pair.listener_path = way_of(scene_.listeners[pair.listener]);
    propagation::ResponseFormat format = format_;
    format.sample_rate = static_cast<double>(recording.sample_rate);
    return propagation::render_moving_pair(
        scene_, simulation_, format, pair, recording.channels.front(), executor, &progress);
}

}  // namespace earshot::cli
