// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/engine.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/channel_count.h"
#include "earshot/propagation/engine/internal/audio_renderer.h"
#include "earshot/propagation/engine/internal/engine_updater.h"
#include "earshot/propagation/engine/internal/packed_rotation.h"
#include "earshot/propagation/engine/internal/path_spectra.h"
#include "earshot/propagation/engine/internal/triple_buffer.h"
#include "earshot/propagation/engine/internal/update_times.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace earshot::propagation {

void validate(const EngineOptions& options) {
    const auto check = [](bool is_valid, const char* subject, const char* what) {
        if (!is_valid) {
            throw Error(subject, what);
        }
    };
    check(options.sample_rate >= 1000.0 && options.sample_rate <= 768000.0,
          "sample rate",
          "must lie in 1000 ... 768000 Hz");
    check(options.block >= 32 && options.block <= 4096 && std::has_single_bit(options.block),
          "block",
          "must be a power of two of 32 ... 4096 samples");
    check(options.ambisonic_order >= 0 && options.ambisonic_order <= audio::kMaxAmbisonicOrder,
          "ambisonic order",
          "must lie in 0 ... 5");
    check(std::isfinite(options.start_time), "start time", "must be a number of seconds");
    check(options.motion_delay >= 0.0 && options.motion_delay <= 10.0,
          "motion delay",
          "must lie in 0 ... 10 seconds");
    check(options.max_delay > 0.0 && options.max_delay <= 10.0,
          "max delay",
          "must be positive and at most 10 seconds");
    check(options.max_paths >= 1 && options.max_paths <= 65536,
          "max paths",
          "must lie in 1 ... 65536");
    check(options.max_filters >= 1 && options.max_filters <= 64,
          "max filters",
          "must lie in 1 ... 64");
    check(options.late_length >= 0.0 && options.late_length <= 20.0,
          "late length",
          "must lie in 0 ... 20 seconds");
    check(options.update_interval >= 0.0 && options.update_interval <= 60.0,
          "update interval",
          "must lie in 0 ... 60 seconds");
    check(options.budget.milliseconds >= 0.0 && std::isfinite(options.budget.milliseconds),
          "budget",
          "must be a number of milliseconds, 0 for none");
}

namespace {

EngineOptions checked(const Scene& scene, const EngineOptions& options) {
    validate(options);
    validate(options.simulation.air);
    if (scene.sources.empty()) {
        throw Error("engine", "the scene has no source", "add one to it");
    }
    if (scene.listeners.empty()) {
        throw Error("engine", "the scene has no listener", "add one to it");
    }
    return options;
}

ControlState initial_state(const Scene& scene, const EngineOptions& options) {
    ControlState state{.scene_time = options.start_time};
    state.sources.resize(scene.sources.size());
    state.listeners.resize(scene.listeners.size());
    return state;
}

}  // namespace

struct Engine::State {
    State(const Scene& scene, const EngineOptions& the_options, Executor& executor)
        : options(checked(scene, the_options)),
          control(initial_state(scene, options)),
          pending(initial_state(scene, options)),
          assembler(options.simulation.bands, options.sample_rate),
          basis(assembler,
                path_spectra(scene, options.simulation),
                {.max_error = kMaxFilterError, .max_filters = options.max_filters}),
          updater(scene, options, basis, executor),
          size{.sources = scene.sources.size(),
               .listeners = scene.listeners.size(),
               .harmonics = updater.harmonics(),
               .outputs = channel_count(options.channels, options.ambisonic_order),
               .tail_channels = updater.tail_channels(),
               .tail_length = updater.tail_length()},
          audio(options, size, basis, speed_of_sound(options.simulation.air), exchange) {
        for (std::size_t listener = 0; listener < size.listeners; ++listener) {
            audio.rotations()[listener] =
                pack_rotation(scene.pose_at(scene.listeners[listener], options.start_time));
        }
    }
    ~State() { stop(); }

    /// What the filters of the engine may miss of a path: -54 dB.
    static constexpr double kMaxFilterError = 2e-3;

    void update();
    std::unique_ptr<Snapshot> free_snapshot();
    void run();
    void stop();

    EngineOptions options;
    TripleBuffer<ControlState> control;
    ControlState pending;  // of the control thread, until it is published
    audio::Assembler assembler;
    audio::FilterBasis basis;
    EngineUpdater updater;
    RenderSize size;
    SnapshotExchange exchange;
    AudioRenderer audio;

    // Update thread.
    std::vector<std::unique_ptr<Snapshot>> free;
    std::size_t made = 0;  // snapshots that exist
    std::thread thread;
    std::mutex mutex;  // of what follows; never of the audio thread
    std::condition_variable wake;
    bool is_ending = false;
    EngineStatistics statistics;  // without what the audio side counts
    UpdateTimes times;
};

// One that came back, or a new one; none if all are with the audio thread.
std::unique_ptr<Snapshot> Engine::State::free_snapshot() {
    while (std::unique_ptr<Snapshot> returned = exchange.take_returned()) {
        if (returned->was_heard) {
            updater.reclaim(returned->number);
        }
        free.push_back(std::move(returned));
    }
    if (!free.empty()) {
        std::unique_ptr<Snapshot> snapshot = std::move(free.back());
        free.pop_back();
        return snapshot;
    }
    if (made == SnapshotExchange::kCount) {
        return nullptr;
    }
    ++made;
    return std::make_unique<Snapshot>();
}

void Engine::State::update() {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    control.take_newest();
    if (std::unique_ptr<Snapshot> snapshot = free_snapshot()) {
        updater.update(control.front(), *snapshot);
        if (std::unique_ptr<Snapshot> unheard = exchange.publish(std::move(snapshot))) {
            free.push_back(std::move(unheard));
        }
    }
    const double milliseconds =
        std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    const UpdateCounts& counts = updater.counts();
    const std::lock_guard lock(mutex);
    times.add(milliseconds);
    ++statistics.updates;
    statistics.work = counts.work;
    statistics.paths = counts.paths;
    statistics.dropped_paths = counts.dropped_paths;
    statistics.deferred_sources = counts.deferred_sources;
    statistics.deferred_late = counts.deferred_late;
    statistics.reduced_late = counts.reduced_late;
    statistics.max_filter_error = counts.max_filter_error;
}

void Engine::State::run() {
    using Clock = std::chrono::steady_clock;
    const auto interval = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(options.update_interval));
    Clock::time_point next = Clock::now();
    for (;;) {
        {
            std::unique_lock lock(mutex);
            if (wake.wait_until(lock, next, [this] { return is_ending; })) {
                return;
            }
        }
        try {
            update();
        } catch (const Error& error) {
            const std::lock_guard lock(mutex);
            ++statistics.failed_updates;
            statistics.last_failure = error.what();
        }
        next = std::max(next + interval, Clock::now());
    }
}

void Engine::State::stop() {
    if (!thread.joinable()) {
        return;
    }
    {
        const std::lock_guard lock(mutex);
        is_ending = true;
    }
    wake.notify_all();
    thread.join();
    is_ending = false;
}

Engine::Engine(const Scene& scene, const EngineOptions& options, Executor& executor)
    : state_(std::make_unique<State>(scene, options, executor)) {
    state_->update();
}

Engine::~Engine() = default;

void Engine::place_source(std::size_t source, const Pose& pose) {
    EARSHOT_ASSERT(source < sources());
    state_->pending.sources[source] = pose;
}

void Engine::place_listener(std::size_t listener, const Pose& pose) {
    EARSHOT_ASSERT(listener < listeners());
    state_->pending.listeners[listener] = pose;
}

void Engine::set_scene_time(double time) {
    state_->pending.scene_time = time;
}

void Engine::publish() noexcept {
    state_->pending.frame = static_cast<std::int64_t>(frames_rendered());
    state_->control.back() = state_->pending;
    state_->control.publish();
}

void Engine::turn_listener(std::size_t listener, const Pose& pose) noexcept {
    EARSHOT_ASSERT(listener < listeners());
    state_->audio.rotations()[listener].store(pack_rotation(pose), std::memory_order_relaxed);
}

void Engine::update() {
    EARSHOT_ASSERT(!state_->thread.joinable());
    state_->update();
}

void Engine::start() {
    if (!state_->thread.joinable()) {
        state_->thread = std::thread([state = state_.get()] { state->run(); });
    }
}

void Engine::stop() {
    state_->stop();
}

void Engine::render(const float* const* inputs,
                    float* const* outputs,
                    std::size_t frames) noexcept {
    state_->audio.render(inputs, outputs, frames);
}

std::size_t Engine::latency() const noexcept {
    return state_->audio.latency();
}
std::uint64_t Engine::frames_rendered() const noexcept {
    return state_->audio.frames();
}
std::size_t Engine::sources() const noexcept {
    return state_->size.sources;
}
std::size_t Engine::listeners() const noexcept {
    return state_->size.listeners;
}
std::size_t Engine::channels() const noexcept {
    return state_->size.outputs;
}
double Engine::sample_rate() const noexcept {
    return state_->options.sample_rate;
}
const EngineOptions& Engine::options() const noexcept {
    return state_->options;
}

EngineStatistics Engine::statistics() const {
    EngineStatistics statistics;
    {
        const std::lock_guard lock(state_->mutex);
        statistics = state_->statistics;
        statistics.median_update_milliseconds = state_->times.median();
        statistics.max_update_milliseconds = state_->times.max_after_first();
    }
    statistics.blocks = state_->audio.frames() / state_->options.block;
    statistics.late_snapshots = state_->audio.late_snapshots();
    statistics.refused_calls = state_->audio.refused_calls();
    statistics.load = state_->audio.load().load();
    return statistics;
}

}  // namespace earshot::propagation
