// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/engine_updater.h"

#include "earshot/audio/spatial.h"
#include "earshot/propagation/internal/path_reception.h"
#include "earshot/propagation/late_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

namespace {

constexpr double kMaxMach = 0.9;
constexpr double kMaxTailLength = 3.0;  // seconds
// What late sound may shrink to when the budget is short, and how many updates it may wait.
constexpr std::size_t kMinRays = 256;
constexpr std::size_t kMinVirtualSources = 64;
constexpr std::uint64_t kMaxLateAge = 40;

Options path_options(const EngineOptions& options) {
    Options early = options.simulation;
    early.rays = 0;
    early.report_paths = true;
    early.keep_traces = true;
    early.report_materials = false;
    early.report_scattering = false;
    return early;
}

std::size_t harmonics_of(const EngineOptions& options) {
    return audio::ambisonic_channels(options.channels == Channels::mono ? 0
                                                                        : options.ambisonic_order);
}

}  // namespace

EngineUpdater::EngineUpdater(const Scene& scene,
                             const EngineOptions& options,
                             const audio::FilterBasis& basis,
                             Executor& executor)
    : scene_(scene),
      options_(options),
      basis_(basis),
      executor_(executor),
      speed_of_sound_(speed_of_sound(options.simulation.air)),
      harmonics_(harmonics_of(options)),
      scene_time_(options.start_time),
      simulator_(scene_, path_options(options), executor),
      pairs_(scene.sources.size() * scene.listeners.size()),
      found_at_(scene.sources.size(), 0),
      harmonics_now_(harmonics_) {
    const EmitterHistory history(options.max_delay + 1.0, kMaxMach * speed_of_sound_);
    source_history_.assign(scene.sources.size(), history);
    listener_history_.assign(scene.listeners.size(), history);
    listeners_.assign(scene.listeners.size(), VoiceSlots(options.max_paths));
    simulator_.set_time(scene_time_, executor);
    prepare_late();
}

void EngineUpdater::reclaim(std::uint64_t number) {
    for (VoiceSlots& slots : listeners_) {
        slots.reclaim(number);
    }
}

void EngineUpdater::update(const ControlState& state, Snapshot& snapshot) {
    const double time = seconds_of(state.frame);
    WorkMeter meter(options_.budget);
    ++number_;
    place(state);
    simulator_.set_time(state.scene_time, executor_);
    follow_emitters(time);
    find_paths(time, meter);
    renew_late(meter);
    allocate_slots();
    snapshot.number = number_;
    snapshot.frame = state.frame;
    snapshot.was_heard = false;
    fill(time, snapshot);
    counts_.work = meter.work();
}

// Into the scene that the simulator reads.
void EngineUpdater::place(const ControlState& state) {
    const auto place_one = [](const std::optional<Pose>& pose, Emitter& emitter) {
        if (pose) {
            emitter.node = -1;
            emitter.position = pose->position;
            emitter.looks_at = pose->position + pose->front;
        }
    };
    for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
        place_one(state.sources[source], scene_.sources[source]);
    }
    for (std::size_t listener = 0; listener < scene_.listeners.size(); ++listener) {
        place_one(state.listeners[listener], scene_.listeners[listener]);
    }
    scene_time_ = state.scene_time;
}

// Who has jumped brings none of his paths along.
void EngineUpdater::follow_emitters(double time) {
    for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
        const geometry::Vec3 position = scene_.position_at(scene_.sources[source], scene_time_);
        if (!source_history_[source].add(time, position)) {
            for (std::size_t listener = 0; listener < listeners_.size(); ++listener) {
                end_paths(source, listener);
            }
        }
    }
    for (std::size_t listener = 0; listener < listeners_.size(); ++listener) {
        const geometry::Vec3 position = scene_.position_at(scene_.listeners[listener], scene_time_);
        if (!listener_history_[listener].add(time, position)) {
            for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
                end_paths(source, listener);
            }
        }
    }
}

void EngineUpdater::end_paths(std::size_t source, std::size_t listener) {
    std::vector<std::uint32_t> ended;
    pair(source, listener).end_all(ended);
    release(listener, ended);
    found_at_[source] = 0;
}

void EngineUpdater::release(std::size_t listener, std::vector<std::uint32_t>& ended) {
    for (const std::uint32_t slot : ended) {
        listeners_[listener].release(slot, number_);
    }
    ended.clear();
}

// Sources without paths first, then by the energy that they bring times the updates that they have
// waited; the first of equals.
std::vector<std::size_t> EngineUpdater::sources_by_priority() const {
    struct Entry {
        bool is_new = false;
        double priority = 0.0;
        std::size_t source = 0;
    };
    std::vector<Entry> entries;
    for (std::size_t source = 0; source < found_at_.size(); ++source) {
        double energy = 0.0;
        for (std::size_t listener = 0; listener < listeners_.size(); ++listener) {
            energy += pairs_[source * listeners_.size() + listener].energy();
        }
        const auto age = static_cast<double>(number_ - found_at_[source]);
        entries.push_back({found_at_[source] == 0, (energy + 1e-12) * age, source});
    }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.is_new != b.is_new ? a.is_new : a.priority > b.priority;
    });
    std::vector<std::size_t> sources;
    for (const Entry& entry : entries) {
        sources.push_back(entry.source);
    }
    return sources;
}

void EngineUpdater::find_paths(double time, WorkMeter& meter) {
    bool is_first = true;
    for (const std::size_t source : sources_by_priority()) {
        if (!is_first && meter.is_spent()) {
            ++counts_.deferred_sources;
            continue;
        }
        find_paths_of(source, time, meter);
        is_first = false;
    }
}

void EngineUpdater::find_paths_of(std::size_t source, double time, WorkMeter& meter) {
    simulator_.select_sources({source});
    const std::vector<PairResult> found = simulator_.run(executor_);
    meter.add(simulator_.statistics().frusta + simulator_.statistics().candidates + 1);
    if (!facets_ || (scene_.mesh.duration() > 0.0 && facet_time_ != scene_time_)) {
        facets_.emplace(simulator_, executor_);
        facet_time_ = scene_time_;
    }
    std::vector<std::uint32_t> ended;
    for (const PairResult& result : found) {
        const double error = pair(source, result.listener)
                                 .follow(time, result.paths, *facets_, basis_, next_id_, ended);
        counts_.max_filter_error = std::max(counts_.max_filter_error, error);
        release(result.listener, ended);
    }
    found_at_[source] = number_;
}

void EngineUpdater::prepare_late() {
    if (options_.simulation.rays == 0) {
        return;
    }
    const Options& simulation = options_.simulation;
    double longest = 0.0;
    for (const Emitter& emitter : scene_.sources) {
        RayOptions rays = {.rays = simulation.rays,
                           .seed = simulation.seed,
                           .specular_order = simulation.specular_order,
                           .bands = simulation.bands,
                           .air = simulation.air,
                           .air_absorption = simulation.air_absorption,
                           .transmission = simulation.transmission,
                           .report_directions = tail_channels() > 1};
        const RaySource source = {.pose = scene_.pose_at(emitter, scene_time_),
                                  .directivity = emitter.directivity};
        constexpr double kDecades = 6.5;  // that late_length() holds
        const double decay = late_length(simulator_.ray_scene(), source, rays, executor_);
        rays.decay_time = decay * 6.0 / kDecades;
        ray_options_.push_back(rays);
        longest = std::max(longest, decay);
    }
    const double length =
        options_.late_length > 0.0 ? options_.late_length : std::min(longest, kMaxTailLength);
    for (RayOptions& rays : ray_options_) {
        rays.length = length;
        if (options_.virtual_sources > 0) {
            coherent_late_.emplace_back(rays);
        }
    }
    tail_length_ = static_cast<std::size_t>(std::ceil(length * options_.sample_rate));
    tail_maker_.emplace(simulation.bands,
                        LateTails::Settings{.channels = tail_channels(),
                                            .sources = scene_.sources.size(),
                                            .length = tail_length_,
                                            .block = options_.block,
                                            .sample_rate = options_.sample_rate,
                                            .seed = options_.seed});
    tails_.resize(pairs_.size());
    late_at_.assign(scene_.sources.size(), 0);
    late_work_.assign(scene_.sources.size(), 0);
}

// One source an update, that whose late sound is oldest; all of them in the first.
void EngineUpdater::renew_late(WorkMeter& meter) {
    if (tail_length_ == 0) {
        return;
    }
    const std::size_t count = number_ == 1 ? late_at_.size() : 1;
    for (std::size_t k = 0; k < count; ++k) {
        const auto oldest = std::min_element(late_at_.begin(), late_at_.end());
        const auto source = static_cast<std::size_t>(oldest - late_at_.begin());
        const std::optional<std::uint64_t> work = coherent_late_.empty()
                                                      ? renew_by_rays(source, meter)
                                                      : renew_by_virtual_sources(source, meter);
        if (!work) {
            ++counts_.deferred_late;
            return;
        }
        meter.add(*work);
        late_at_[source] = number_;
    }
}

bool EngineUpdater::has_waited_long(std::size_t source) const {
    return number_ - late_at_[source] > kMaxLateAge;
}

std::optional<std::uint64_t> EngineUpdater::renew_by_rays(std::size_t source,
                                                          const WorkMeter& meter) {
    const std::size_t all = options_.simulation.rays;
    const std::uint64_t expected = std::max<std::uint64_t>(late_work_[source], 1);
    const double share = static_cast<double>(meter.left(expected)) / static_cast<double>(expected);
    auto rays = static_cast<std::size_t>(static_cast<double>(all) * share);
    if (rays < std::min(kMinRays, all)) {
        if (!has_waited_long(source)) {
            return std::nullopt;
        }
        rays = std::min(kMinRays, all);
    }
    counts_.reduced_late += rays < all ? 1 : 0;
    RayOptions ray_options = ray_options_[source];
    ray_options.rays = rays;
    const LateEnergy late = trace_late_rays(
        simulator_.ray_scene(), ray_source(source), listener_positions(), ray_options, executor_);
    set_tails(source, late.listeners);
    // What all rays would have taken.
    late_work_[source] = late.balance.bounces * all / rays;
    return late.balance.bounces;
}

// A budget of half as many keeps half of the choices: the winners of two slots, one of which wins
// where these are one.
std::optional<std::uint64_t> EngineUpdater::renew_by_virtual_sources(std::size_t source,
                                                                     const WorkMeter& meter) {
    const std::size_t min_budget = std::min(kMinVirtualSources, options_.virtual_sources);
    std::size_t budget = options_.virtual_sources;
    const auto fits = [&] {
        const std::uint64_t expected = late_work_[source] + budget * listeners_.size();
        return meter.left(expected) == expected;
    };
    while (!fits() && budget / 2 >= min_budget) {
        budget /= 2;
    }
    if (!fits() && !has_waited_long(source)) {
        return std::nullopt;
    }
    counts_.reduced_late += budget < options_.virtual_sources ? 1 : 0;
    late_work_[source] =
        coherent_late_[source].update(simulator_.ray_scene(), ray_source(source), executor_);
    set_tails(source, coherent_late_[source].estimate(listener_positions(), budget, executor_));
    return late_work_[source] + budget * listeners_.size();
}

RaySource EngineUpdater::ray_source(std::size_t source) const {
    const Emitter& emitter = scene_.sources[source];
    return {.pose = scene_.pose_at(emitter, scene_time_), .directivity = emitter.directivity};
}

std::vector<geometry::Vec3> EngineUpdater::listener_positions() const {
    std::vector<geometry::Vec3> positions;
    for (const Emitter& listener : scene_.listeners) {
        positions.push_back(scene_.position_at(listener, scene_time_));
    }
    return positions;
}

void EngineUpdater::set_tails(std::size_t source,
                              std::span<const audio::EnergyHistogram> histograms) {
    for (std::size_t listener = 0; listener < histograms.size(); ++listener) {
        tails_[source * listeners_.size() + listener] =
            tail_maker_->make(histograms[listener], source);
    }
}

// Paths that have no voice yet get one, the loudest first.
void EngineUpdater::allocate_slots() {
    for (std::size_t listener = 0; listener < listeners_.size(); ++listener) {
        std::vector<TrackedPath*> silent;
        for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
            for (auto& [key, path] : pair(source, listener).paths()) {
                if (path.slot == VoiceSlots::kNone &&
                    path.length < options_.max_delay * speed_of_sound_) {
                    silent.push_back(&path);
                }
            }
        }
        std::stable_sort(
            silent.begin(), silent.end(), [](const TrackedPath* a, const TrackedPath* b) {
                return a->level > b->level;
            });
        for (TrackedPath* path : silent) {
            path->slot = listeners_[listener].allocate();
            counts_.dropped_paths += path->slot == VoiceSlots::kNone ? 1 : 0;
        }
    }
}

void EngineUpdater::fill(double time, Snapshot& snapshot) {
    snapshot.listeners.resize(listeners_.size());
    counts_.paths = 0;
    for (std::size_t listener = 0; listener < listeners_.size(); ++listener) {
        ListenerSnapshot& to = snapshot.listeners[listener];
        to.arrivals.clear();
        to.weights.clear();
        to.gains.clear();
        to.tails.clear();
        to.tail_pointers.clear();
        for (std::size_t source = 0; source < scene_.sources.size(); ++source) {
            add_arrivals(source, listener, time, to);
            if (tail_length_ > 0) {
                to.tails.push_back(tails_[source * listeners_.size() + listener]);
                to.tail_pointers.push_back(to.tails.back().get());
            }
        }
        counts_.paths += to.arrivals.size();
    }
}

void EngineUpdater::add_arrivals(std::size_t source,
                                 std::size_t listener,
                                 double time,
                                 ListenerSnapshot& to) {
    const Trajectory& way = source_history_[source].trajectory();
    const Motion motion = listener_history_[listener].motion();
    const Pose still{};
    for (const auto& entry : pair(source, listener).paths()) {
        const TrackedPath& path = entry.second;
        if (path.slot == VoiceSlots::kNone) {
            continue;
        }
        const PathReception reception =
            receive_path([&](double) -> const MovingUnfoldedPath& { return path.unfolded; },
                         way,
                         motion,
                         time,
                         speed_of_sound_,
                         time - path.length / speed_of_sound_);
        to.arrivals.push_back({.slot = path.slot,
                               .source = static_cast<std::uint32_t>(source),
                               .id = path.id,
                               .delay = reception.delay * options_.sample_rate,
                               .delay_rate = reception.delay_rate});
        to.weights.insert(to.weights.end(), path.weights.begin(), path.weights.end());
        const geometry::Vec3 towards = still.seen_from(-reception.arrival);
        if (harmonics_ > 1) {
            audio::spherical_harmonics(
                options_.ambisonic_order, {towards.x, towards.y, towards.z}, harmonics_now_);
        } else {
            harmonics_now_[0] = 1.0;
        }
        to.gains.insert(to.gains.end(), harmonics_now_.begin(), harmonics_now_.end());
    }
}

}  // namespace earshot::propagation
