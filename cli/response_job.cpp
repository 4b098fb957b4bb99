// SPDX-License-Identifier: MIT
#include "earshot/cli/response_job.h"

#include "earshot/base/stage_progress.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/io/metrics.h"
#include "earshot/io/result_names.h"
#include "earshot/io/results.h"
#include "earshot/io/room_sofa.h"
#include "earshot/io/scene_picture.h"
#include "earshot/io/sensitivity.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/decay_notes.h"
#include "earshot/propagation/pair_notes.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <iterator>
#include <string>
#include <system_error>

namespace earshot::cli {
namespace {

using propagation::PairResult;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void make_directory(const std::filesystem::path& directory) {
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);
    if (failure || !std::filesystem::is_directory(directory, failure)) {
        throw Error(
            directory.string(),
            "cannot be created as a folder" + (failure ? " (" + failure.message() + ")" : ""),
            "choose another folder with -o");
    }
    io::require_writable(directory / "paths.json");
}

/// One job under way.
class Run {
public:
    Run(const ResponseJob& job, Executor& executor, Progress& progress)
        : job_(job),
          executor_(executor),
          progress_(progress),
          names_(job.scene),
          renderer_(job.simulation.bands, job.format) {
        summary_.size = propagation::scene_extent(job.scene, job.times.front()).size();
        const int max_order = job.simulation.specular_order + job.simulation.diffraction;
        summary_.paths_of_order.resize(static_cast<std::size_t>(max_order) + 1);
    }

    ResponseSummary run() {
        progress_.report("preparing", 0, 1);
        auto start = std::chrono::steady_clock::now();
        propagation::Simulator simulator(job_.scene, job_.simulation, executor_);
        summary_.notes = simulator.warnings(executor_);
        progress_.report("preparing", 1, 1);
        make_directory(job_.directory);  // before the long work, but not for a scene without sense
        if (!job_.plan.empty()) {
            io::require_writable(plan_of(0));
        }
        for (std::size_t frame = 0; frame < job_.times.size(); ++frame) {
            simulator.set_time(job_.times[frame], executor_);
            const double prepare_seconds = seconds_since(start);
            summary_.prepare_seconds += prepare_seconds;

            start = std::chrono::steady_clock::now();
            // Of one instant the simulator reports, of many this job.
            const bool is_alone = job_.times.size() == 1;
            if (!is_alone) {
                progress_.report("tracing", frame, job_.times.size());
            }
            std::vector<PairResult> pairs =
                simulator.run(executor_, is_alone ? &progress_ : nullptr);
            const double trace_seconds = seconds_since(start);
            summary_.trace_seconds += trace_seconds;
            summary_.update_seconds.push_back(prepare_seconds + trace_seconds);
            add_statistics(simulator);
            if (frame == 0 && job_.format.report_metrics) {
                summary_.room = room_at(job_.times[frame], simulator);
            }
            for (const PairResult& pair : pairs) {
                summary_.visible_volume = std::max(summary_.visible_volume, pair.visible_volume);
            }
            if (job_.check_visibility) {
                count_lost_paths(pairs, job_.times[frame]);
            }

            start = std::chrono::steady_clock::now();
            write_responses(pairs, frame);
            explain_decays(simulator, frame);
            if (job_.simulation.report_materials) {
                add_sensitivity(pairs);
            }
            std::move(pairs.begin(), pairs.end(), std::back_inserter(all_pairs_));
            summary_.response_seconds += seconds_since(start);
            start = std::chrono::steady_clock::now();
        }
        summary_.prepare_seconds += describe_geometry(simulator);
        if (job_.simulation.diffraction == 0) {
            const Warnings notes = propagation::note_blocked_pairs(job_.scene, all_pairs_);
            summary_.notes.insert(summary_.notes.end(), notes.begin(), notes.end());
        }
        write_tables();
        write_plans();
        summary_.response_seconds += seconds_since(start);
        return std::move(summary_);
    }

private:
    /// At the last instant. Returns the seconds that it took.
    double describe_geometry(const propagation::Simulator& simulator) {
        const auto start = std::chrono::steady_clock::now();
        summary_.geometry = simulator.geometry(executor_);
        summary_.hierarchies = simulator.hierarchy_statistics();
        return seconds_since(start);
    }

    void add_statistics(const propagation::Simulator& simulator) {
        summary_.statistics += simulator.statistics();
    }

    std::optional<propagation::RoomStatistics> room_at(double time,
                                                       const propagation::Simulator& simulator) {
        std::vector<geometry::Vec3> sources;
        for (const propagation::Emitter& source : job_.scene.sources) {
            sources.push_back(job_.scene.pose_at(source, time).position);
        }
        return propagation::room_statistics(
            simulator.ray_scene(), sources, room_options(), executor_);
    }
    propagation::RoomStatisticsOptions room_options() const {
        return {.bands = job_.simulation.bands,
                .air = job_.simulation.air,
                .air_absorption = job_.simulation.air_absorption};
    }

    /// Visible sets only ever leave paths out.
    void count_lost_paths(const std::vector<PairResult>& pairs, double time) {
        propagation::Options complete = job_.simulation;
        complete.visible_sets = nullptr;
        complete.rays = 0;
        propagation::Simulator simulator(job_.scene, complete, executor_);
        simulator.set_time(time, executor_);
        for (const PairResult& pair : simulator.run(executor_)) {
            summary_.paths_lost += pair.paths.size();
        }
        for (const PairResult& pair : pairs) {
            summary_.paths_lost -= pair.paths.size();
        }
    }

    /// Of the first time, of which the room is known.
    void explain_decays(const propagation::Simulator& simulator, std::size_t frame) {
        if (frame == 0 && summary_.room) {
            const Warnings notes = propagation::explain_long_decays(
                simulator, job_.scene, *summary_.room, room_options(), summary_.metrics, executor_);
            summary_.notes.insert(summary_.notes.end(), notes.begin(), notes.end());
        }
    }

    void write(const std::string& name, const std::string& bytes) {
        summary_.files.push_back(job_.directory / name);
        io::write_whole_file(summary_.files.back(), bytes);
    }

    void write_responses(const std::vector<PairResult>& pairs, std::size_t frame) {
        // Pairs are independent; what they make is kept in order and written in order.
        std::vector<std::string> sounds(pairs.size());
        std::vector<propagation::Response> responses(pairs.size());
        StageProgress rendered(
            &progress_, "responses", job_.times.size() * pairs.size(), frame * pairs.size());
        executor_.for_each(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                responses[i] = renderer_.render(
                    pairs[i],
                    job_.scene.pose_at(job_.scene.listeners[pairs[i].listener], pairs[i].time),
                    executor_);
                sounds[i] = io::encode_response(responses[i].channels);
                rendered.add(1);
            }
        });
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const std::string& name = names_.of(pairs[i].source, pairs[i].listener);
            const Warnings notes = propagation::note_sound(pairs[i], name);
            summary_.notes.insert(summary_.notes.end(), notes.begin(), notes.end());
            for (const propagation::Path& path : pairs[i].paths) {
                ++summary_.paths_of_order[static_cast<std::size_t>(path.order)];
            }
            write(name + (job_.is_sequence ? frame_suffix(frame) : "") + ".wav", sounds[i]);
            if (job_.format.report_metrics) {
                summary_.metrics.push_back(std::move(responses[i].metrics));
            }
            if (job_.write_sofa) {
                measurements_.push_back(
                    {.source =
                         job_.scene.pose_at(job_.scene.sources[pairs[i].source], pairs[i].time),
                     .listener =
                         job_.scene.pose_at(job_.scene.listeners[pairs[i].listener], pairs[i].time),
                     .channels = std::move(responses[i].channels)});
            }
        }
    }

    /// Pairs are independent.
    void add_sensitivity(const std::vector<PairResult>& pairs) {
        std::vector<propagation::PairSensitivity> found(pairs.size());
        executor_.for_each(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                found[i] = propagation::pair_sensitivity(
                    job_.scene,
                    pairs[i],
                    {.bands = job_.simulation.bands, .speech = job_.format.speech});
            }
        });
        std::move(found.begin(), found.end(), std::back_inserter(summary_.sensitivity));
    }

    void write_tables() {
        const io::ResultHeader header = {
            .scene = job_.scene,
            .bands = job_.simulation.bands,
            .speed_of_sound = propagation::speed_of_sound(job_.simulation.air)};
        std::vector<propagation::Pose> listeners;
        for (const PairResult& pair : all_pairs_) {
            listeners.push_back(job_.scene.pose_at(job_.scene.listeners[pair.listener], pair.time));
        }
        ResponseTexts texts{.paths = io::encode_paths(header, all_pairs_, listeners)};
        write("paths.json", texts.paths);
        if (job_.format.report_metrics) {
            texts.metrics = io::encode_metrics({.scene = job_.scene,
                                                .bands = job_.simulation.bands,
                                                .room = summary_.room,
                                                .speech = job_.format.speech},
                                               summary_.metrics);
            write("metrics.json", texts.metrics);
        }
        if (job_.write_histograms || job_.keep_texts) {
            texts.histograms = io::encode_histograms(header, all_pairs_);
        }
        if (job_.write_histograms) {
            write("histograms.json", texts.histograms);
        }
        if (job_.simulation.report_materials) {
            summary_.material_areas = propagation::material_areas(job_.scene, job_.times.front());
            texts.sensitivity = io::encode_sensitivity({.scene = job_.scene,
                                                        .bands = job_.simulation.bands,
                                                        .areas = summary_.material_areas},
                                                       summary_.sensitivity);
        }
        if (job_.write_sensitivity) {
            write("sensitivity.json", texts.sensitivity);
        }
        if (job_.keep_texts) {
            summary_.texts = std::move(texts);
        }
        if (job_.write_sofa) {
            write("responses.sofa",
                  io::encode_room_responses(job_.scene.name, job_.format.channels, measurements_));
        }
    }

    std::filesystem::path plan_of(std::size_t frame) const {
        std::filesystem::path name = job_.plan.stem();
        name += job_.is_sequence ? frame_suffix(frame) : "";
        name += job_.plan.extension();
        return job_.plan.parent_path() / name;
    }

    void write_plans() {
        if (job_.plan.empty()) {
            return;
        }
        io::ScenePictures pictures(job_.scene, job_.times, all_pairs_, {}, executor_);
        for (std::size_t frame = 0; frame < job_.times.size(); ++frame) {
            summary_.files.push_back(plan_of(frame));
            io::write_whole_file(summary_.files.back(), pictures.draw(frame, executor_).svg);
        }
    }

    const ResponseJob& job_;
    Executor& executor_;
    Progress& progress_;
    io::ResultNames names_;
    propagation::ResponseRenderer renderer_;
    std::vector<PairResult> all_pairs_;
    std::vector<io::RoomMeasurement> measurements_;
    ResponseSummary summary_;
};

}  // namespace

ResponseSummary run_response_job(const ResponseJob& job, Executor& executor, Progress& progress) {
    return Run(job, executor, progress).run();
}

}  // namespace earshot::cli
