// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/map_area_options.h"
#include "earshot/cli/map_limit_options.h"
#include "earshot/cli/map_outputs.h"
#include "earshot/cli/map_summary.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/report_output.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/simulation_choice.h"
#include "earshot/cli/speech_options.h"
#include "earshot/io/map_table.h"
#include "earshot/io/report_map.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/metric_map.h"
#include "earshot/propagation/plausibility.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

constexpr int kLimitMissed = 3;

constexpr const char* kFooter =
    "The values are those that earshot ir tells of a listener at each point, expected ones from "
    "the\n"
    "energies that arrive, without making responses. Cells begin at --coarse-step and are halved\n"
    "down to --step where a value differs from the next cell's by more than its just-noticeable\n"
    "difference (T30 5 %, C80 1 dB, STI 0.03) and their standard error.\n"
    "Exit status 3: less than --share of the area keeps a --limit, for some source.\n\n"
    "Examples:\n"
    "  earshot map scenes/classroom.gltf --on linoleum-on-concrete -o map.svg\n"
    "      STI, T30 and C80 at ears 1.2 m above the floor\n"
    "  earshot map scenes/classroom.gltf --rect 0.5,0.5,6.7,8 --height 1.2 --step 0.5 \\\n"
    "      --metric sti --noise NC-35 --limit sti=0.6 --share 90 -o sti.png -o sti.csv\n"
    "      where STI is at least 0.6; fails unless that is nine tenths of the area\n"
    "  earshot map hall.obj --source 0,1.5,0 --points seats.csv --metric g,c80 -o g.csv\n"
    "      at the seats of a table";

class MapCommand : public Command {
public:
    explicit MapCommand(CLI::App& program)
        : Command(program, "map", "Room-acoustic metrics over an area", {.seed = true}) {
        scene_.add_to(app());
        outputs_.add_to(app());
        area_.add_to(app());
        limits_.add_to(app());
        emitters_.add_sources_to(app());
        materials_.add_to(app());
        simulation_.add_to(app());
        speech_.add_to(app(), "1 m in front of the talker");
        app().add_flag(
            "--report",
            writes_report_,
            "also write a page for the browser that shows the maps, named like the first "
            "output, .html");
        app().footer(kFooter);
    }

    void run() override {
        area_.check(app());
        outputs_.check(app());
        if (writes_report_) {
            require_report(outputs_.page_file(app()));
        }
        propagation::MapOptions options{.simulation = simulation_.options(app(), common().seed),
                                        .speech = speech_.conditions(app()),
                                        .step = area_.step(),
                                        .coarse_step = area_.coarse_step(),
                                        .clearance = area_.clearance()};
        const auto metrics = limits_.metrics(app(), options.simulation.bands);
        const auto limits = limits_.limits(app(), metrics);
        override_simd_target(common().simd);

        io::LoadedScene loaded = scene_.load();
        materials_.apply(scene_.file(), loaded);
        emitters_.apply(app(), scene_, loaded.scene);
        const double time = scene_.times(app()).front();
        const propagation::MapArea area = area_.area(app(), scene_, loaded.scene);
        Executor executor(static_cast<int>(common().threads));
        const auto start = std::chrono::steady_clock::now();
        const propagation::MetricMap map = [&] {
            ProgressBar progress(common().quiet);
            return propagation::compute_metric_map(
                loaded.scene, time, area, metrics, options, executor, &progress);
        }();
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        std::vector<std::string> files = outputs_.write(loaded.scene, map, limits);
        if (writes_report_) {
            files.push_back(write_page(loaded, map, limits));
        }
        report(loaded, time, map, MapSummary(loaded.scene, map, limits), seconds, files);
    }

private:
    /// The error is that of a band; the mean of two bands is then known to half a just-noticeable
    /// difference. A few hard points must not trace rays for all.
    static constexpr SimulationChoice::Defaults kDefaults = {
        .order = 3, .rays_error_percent = 4.0, .max_auto_rays = 200000};

    void report(io::LoadedScene& loaded,
                double time,
                const propagation::MetricMap& map,
                const MapSummary& summary,
                double seconds,
                const std::vector<std::string>& files) {
        if (!common().quiet) {
            const Warnings misplaced = propagation::misplaced_emitters(loaded.scene, time);
            print_warnings(loaded.warnings);
            print_warnings(io::warnings_of_acoustics(loaded));
            print_warnings(misplaced);
            print_warnings(unknown_values(map));
        }
        if (common().json) {
            write_output(summary.json(seconds, files));
        } else if (!common().quiet) {
            write_output(summary.text(seconds, files));
        }
        if (summary.min_share() < limits_.share()) {
            set_exit_status(kLimitMissed);
        }
    }

    /// Returns the name of its file.
    std::string write_page(const io::LoadedScene& loaded,
                           const propagation::MetricMap& map,
                           const std::vector<propagation::MapLimit>& limits) {
        Warnings warnings = loaded.warnings;
        for (const Warnings& more : {io::warnings_of_acoustics(loaded), unknown_values(map)}) {
            warnings.insert(warnings.end(), more.begin(), more.end());
        }
        const std::filesystem::path file = outputs_.page_file(app());
        write_report(file,
                     io::encode_map_page(
                         {.title = std::filesystem::path(loaded.scene.name).stem().string(),
                          .provenance = {.version = program_version(),
                                         .command = command_line(),
                                         .seed = static_cast<std::uint64_t>(common().seed),
                                         .files = {loaded.scene.name}},
                          .map = {"map.json", io::encode_map_json(loaded.scene.name, map, limits)},
                          .scene = &loaded.scene,
                          .default_materials = loaded.default_materials,
                          .min_share = limits_.share() > 0.0 ? limits_.share() : 1.0,
                          .warnings = std::move(warnings)}));
        return file.string();
    }

    /// Where a metric has no value, and what would help.
    static Warnings unknown_values(const propagation::MetricMap& map) {
        Warnings warnings;
        for (std::size_t source = 0; source < map.sources.size(); ++source) {
            for (std::size_t metric = 0; metric < map.metrics.size(); ++metric) {
                std::size_t unknown = 0;
                for (std::size_t k = 0; k < map.cells.size(); ++k) {
                    unknown += map.exclusions[k] == propagation::PointExclusion::none &&
                                       !map.value(k, source, metric).value
                                   ? 1
                                   : 0;
                }
                if (unknown > 0) {
                    warnings.push_back({map.sources[source],
                                        map.metrics[metric].name() + " is not known at " +
                                            std::to_string(unknown) +
                                            " points; more rays (--rays, --rays-error) tell more"});
                }
            }
        }
        return warnings;
    }

    SceneChoice scene_;
    MapOutputs outputs_;
    MapAreaOptions area_;
    MapLimitOptions limits_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    SimulationChoice simulation_{kDefaults};
    SpeechOptions speech_;
    bool writes_report_ = false;
};

}  // namespace

std::unique_ptr<Command> make_map_command(CLI::App& program) {
    return std::make_unique<MapCommand>(program);
}

}  // namespace earshot::cli
