// SPDX-License-Identifier: MIT
#include "earshot/propagation/moving_sound.h"

#include "earshot/audio/convolve.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/moving_early_sound.h"
#include "earshot/propagation/internal/response_parts.h"
#include "earshot/propagation/moving_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace earshot::propagation {

namespace {

using Signals = std::vector<std::vector<double>>;

constexpr double kMaxMach = 0.9;

constexpr double kMaxInstants = 100000.0;

/// `seconds`: the length of the recording.
void check_step(const char* subject, double step, double seconds) {
    if (!(step > 0.0) || !std::isfinite(step)) {
        throw Error(subject, "must be a positive number of seconds", "0.05 is usual");
    }
    if (!(seconds / step <= kMaxInstants)) {
        throw Error(
            subject, "makes more than 100000 instants of the recording", "take a longer one");
    }
}

Trajectory checked_trajectory(const Emitter& emitter,
                              Trajectory trajectory,
                              double speed_of_sound) {
    if (!(trajectory.max_speed() <= kMaxMach * speed_of_sound)) {
        throw Error(emitter.name,
                    "moves at more than 0.9 of the speed of sound",
                    "check the times and positions of its way");
    }
    return trajectory;
}

/// A scene with one source and one listener, which can be placed anywhere.
class PlacedPair {
public:
    PlacedPair(const Scene& scene, const MovingPair& pair, double end, double speed_of_sound)
        : scene_(scene),
          source_path_(path_of(scene.sources[pair.source], pair.source_path, pair.start, end)),
          listener_path_(
              path_of(scene.listeners[pair.listener], pair.listener_path, pair.start, end)) {
        scene_.sources = {scene.sources[pair.source]};
        scene_.listeners = {scene.listeners[pair.listener]};
        source_path_ = checked_trajectory(scene_.sources[0], source_path_, speed_of_sound);
        listener_path_ = checked_trajectory(scene_.listeners[0], listener_path_, speed_of_sound);
        moves_source_ = pair.source_path.has_value();
        moves_listener_ = pair.listener_path.has_value();
        place(pair.start);
    }

    const Scene& scene() const noexcept { return scene_; }
    const Trajectory& source_path() const noexcept { return source_path_; }
    const Trajectory& listener_path() const noexcept { return listener_path_; }

    /// Moves what has a trajectory of its own to where it is at `time`.
    void place(double time) {
        if (moves_source_) {
            place_at(source_path_, time, scene_.sources[0]);
        }
        if (moves_listener_) {
            place_at(listener_path_, time, scene_.listeners[0]);
        }
    }

    /// How the listener is turned. A way of its own turns nobody.
    audio::Orientation orientation_at(double time) const {
        Emitter listener = scene_.listeners[0];
        if (moves_listener_) {
            place_at(listener_path_, time, listener);
        }
        return orientation_of(scene_.pose_at(listener, time));
    }

private:
    Trajectory path_of(const Emitter& emitter,
                       const std::optional<Trajectory>& own,
                       double begin,
                       double end) const {
        return own ? *own : trajectory_of(scene_, emitter, begin, end);
    }
    static void place_at(const Trajectory& path, double time, Emitter& emitter) {
        emitter.node = -1;
        emitter.position = path.at(time).position;
    }

    Scene scene_;
    Trajectory source_path_, listener_path_;
    bool moves_source_ = false, moves_listener_ = false;
};

/// One rendering under way.
class MovingRendering {
public:
    MovingRendering(const Scene& scene,
                    const Options& simulation,
                    const ResponseFormat& format,
                    const MovingPair& pair,
                    std::span<const double> recording,
                    Executor& executor,
                    Progress* progress)
        : simulation_(simulation),
          format_(checked_format(format)),
          pair_(pair),
          recording_(recording),
          executor_(executor),
          progress_(progress),
          end_(pair.start + static_cast<double>(recording.size()) / format.sample_rate),
          assembler_(simulation.bands, format.sample_rate),
          hrirs_(prepared_hrirs(format_)),
          // The listener moves on until the last sound has come.
          placed_(scene, pair, end_ + kMaxDelay, speed_of_sound(simulation.air)) {}

    MovingSound render() {
        MovingSound result;
        const MovingPaths paths = find_paths();
        result.instants = paths.times().size();
        result.paths = paths.paths().size();
        Signals channels = early(paths);
        if (simulation_.rays > 0) {
            add(late(result.late_instants), channels);
        }
        result.signal = {.sample_rate = static_cast<std::int64_t>(format_.sample_rate),
                         .channels = std::move(channels)};
        return result;
    }

private:
    static constexpr double kMaxDelay = 10.0;  // seconds of the listener's way that are looked up

    /// From the begin until the recording is over.
    std::vector<double> instants(double step) const {
        std::vector<double> times;
        const double count = std::ceil((end_ - pair_.start) / step);
        for (double k = 0.0; k <= std::max(count, 1.0); k += 1.0) {
            times.push_back(pair_.start + k * step);
        }
        return times;
    }

    MovingPaths find_paths() {
        Options options = simulation_;
        options.rays = 0;
        options.report_paths = true;
        options.keep_traces = true;
        Simulator simulator(placed_.scene(), options, executor_);
        const bool is_still = !(placed_.scene().mesh.duration() > 0.0);
        std::optional<FacetTable> facets;
        MovingPaths paths;
        const std::vector<double> times = instants(pair_.step);
        for (std::size_t k = 0; k < times.size(); ++k) {
            placed_.place(times[k]);
            simulator.set_time(times[k], executor_);
            const std::vector<PairResult> found = simulator.run(executor_);
            if (!facets || !is_still) {
                facets.emplace(simulator, executor_);
            }
            paths.add(times[k], found.front().paths, *facets);
            if (progress_ != nullptr) {
                progress_->report("tracing", k + 1, times.size());
            }
        }
        return paths;
    }

    Signals early(const MovingPaths& paths) {
        const MovingEarlySound sound = {
            .paths = paths,
            .source = placed_.source_path(),
            .listener = placed_.listener_path(),
            .orientation_at = [this](double time) { return placed_.orientation_at(time); },
            .format = format_,
            .hrirs = hrirs_,
            .assembler = assembler_,
            .speed_of_sound = speed_of_sound(simulation_.air),
            .start = pair_.start};
        return render_early_sound(sound, recording_, executor_, progress_);
    }

    /// The tails of instants one after the other. They are the same noise under envelopes of their
    /// own, so that a fade from one to the next is neither weaker nor louder than both.
    Signals late(std::size_t& count) {
        Options options = simulation_;
        options.report_paths = false;
        options.late_directions = format_.channels != Channels::mono;
        Simulator simulator(placed_.scene(), options, executor_);
        const std::uint64_t key = pair_key(placed_.scene(), 0, 0);
        const LateFormat late_format = {.bands = simulation_.bands,
                                        .format = format_,
                                        .channels = format_.channels,
                                        .hrirs = hrirs_,
                                        .cache = cache_,
                                        .seed = random_bits(format_.seed, key, 0)};
        const std::vector<double> times = instants(pair_.late_step);
        std::vector<Signals> tails;  // per instant
        std::vector<double> places;
        std::optional<double> reflection_growth;
        for (std::size_t k = 0; k < times.size(); ++k) {
            placed_.place(times[k]);
            simulator.set_time(times[k], executor_);
            audio::EnergyHistogram histogram = std::move(simulator.run(executor_).front().late);
            // The density of its impulses decides where they lie.
            reflection_growth = reflection_growth.value_or(histogram.reflection_growth);
            histogram.reflection_growth = *reflection_growth;
            tails.push_back(
                late_channels(late_format, histogram, placed_.orientation_at(times[k])));
            places.push_back((times[k] - pair_.start) * format_.sample_rate);
            if (progress_ != nullptr) {
                progress_->report("late rays", k + 1, times.size());
            }
        }
        count = times.size();
        Signals channels;
        for (std::size_t channel = 0; channel < tails.front().size(); ++channel) {
            std::vector<std::vector<double>> filters;
            for (Signals& tail : tails) {
                filters.push_back(std::move(tail[channel]));
            }
            channels.push_back(audio::convolve_moving(recording_, filters, places, executor_));
        }
        return channels;
    }

    static void add(const Signals& late, Signals& channels) {
        for (std::size_t channel = 0; channel < channels.size(); ++channel) {
            std::vector<double>& sum = channels[channel];
            sum.resize(std::max(sum.size(), late[channel].size()), 0.0);
            for (std::size_t n = 0; n < late[channel].size(); ++n) {
                sum[n] += late[channel][n];
            }
        }
    }

    const Options& simulation_;
    ResponseFormat format_;
    const MovingPair& pair_;
    std::span<const double> recording_;
    Executor& executor_;
    Progress* progress_;
    double end_;
    audio::Assembler assembler_;
    std::optional<audio::HrirInterpolator> hrirs_;
    audio::FilterCache cache_;
    PlacedPair placed_;
};

}  // namespace

MovingSound render_moving_pair(const Scene& scene,
                               const Options& simulation,
                               const ResponseFormat& format,
                               const MovingPair& pair,
                               std::span<const double> recording,
                               Executor& executor,
                               Progress* progress) {
    const double seconds = static_cast<double>(recording.size()) / format.sample_rate;
    check_step("step", pair.step, seconds);
    check_step("step of late sound", pair.late_step, seconds);
    validate(simulation.air);
    return MovingRendering(scene, simulation, format, pair, recording, executor, progress).render();
}

}  // namespace earshot::propagation
