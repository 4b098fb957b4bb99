// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_basis.h"
#include "earshot/base/parallel.h"
#include "earshot/propagation/coherent_late_sound.h"
#include "earshot/propagation/engine/engine_options.h"
#include "earshot/propagation/engine/internal/control_state.h"
#include "earshot/propagation/engine/internal/emitter_history.h"
#include "earshot/propagation/engine/internal/late_tails.h"
#include "earshot/propagation/engine/internal/snapshot.h"
#include "earshot/propagation/engine/internal/tracked_paths.h"
#include "earshot/propagation/engine/internal/update_budget.h"
#include "earshot/propagation/engine/internal/voice_slots.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Counts of an updater; the rest of EngineStatistics is the engine's.
struct UpdateCounts {
    std::uint64_t work = 0;
    std::size_t paths = 0;
    std::uint64_t dropped_paths = 0, deferred_sources = 0, deferred_late = 0, reduced_late = 0;
    double max_filter_error = 0.0;
};

/// The update side of an engine: finds paths for a state and makes snapshots of them. All of it
/// belongs to the update thread.
class EngineUpdater {
public:
    /// `basis` and `executor` must outlive it.
    EngineUpdater(const Scene& scene,
                  const EngineOptions& options,
                  const audio::FilterBasis& basis,
                  Executor& executor);

    /// Samples of late sound; 0: none.
    std::size_t tail_length() const noexcept { return tail_length_; }
    std::size_t harmonics() const noexcept { return harmonics_; }
    std::size_t tail_channels() const noexcept { return harmonics_ >= 4 ? 4 : 1; }

    /// Finds paths and fills a snapshot. Throws Error as Simulator::run().
    void update(const ControlState& state, Snapshot& snapshot);
    /// The sound has gone on from a snapshot.
    void reclaim(std::uint64_t number);
    const UpdateCounts& counts() const noexcept { return counts_; }

private:
    TrackedPaths& pair(std::size_t source, std::size_t listener) {
        return pairs_[source * listeners_.size() + listener];
    }
    double seconds_of(std::int64_t frame) const noexcept {
        return static_cast<double>(frame) / options_.sample_rate;
    }
    void place(const ControlState& state);
    void follow_emitters(double time);
    std::vector<std::size_t> sources_by_priority() const;
    void find_paths(double time, WorkMeter& meter);
    void find_paths_of(std::size_t source, double time, WorkMeter& meter);
    void end_paths(std::size_t source, std::size_t listener);
    void release(std::size_t listener, std::vector<std::uint32_t>& ended);
    void prepare_late();
    void renew_late(WorkMeter& meter);
    /// How much work it was; nothing: late sound waits.
    std::optional<std::uint64_t> renew_by_rays(std::size_t source, const WorkMeter& meter);
    std::optional<std::uint64_t> renew_by_virtual_sources(std::size_t source,
                                                          const WorkMeter& meter);
    bool has_waited_long(std::size_t source) const;
    RaySource ray_source(std::size_t source) const;
    std::vector<geometry::Vec3> listener_positions() const;
    void set_tails(std::size_t source, std::span<const audio::EnergyHistogram> histograms);
    void allocate_slots();
    void fill(double time, Snapshot& snapshot);
    void add_arrivals(std::size_t source, std::size_t listener, double time, ListenerSnapshot& to);

    Scene scene_;
    EngineOptions options_;
    const audio::FilterBasis& basis_;
    Executor& executor_;
    double speed_of_sound_;
    std::size_t harmonics_;
    double scene_time_;
    Simulator simulator_;
    std::optional<FacetTable> facets_;
    double facet_time_ = 0.0;

    std::uint64_t number_ = 0;  // of the snapshot that is being made
    std::uint64_t next_id_ = 1;
    std::vector<EmitterHistory> source_history_, listener_history_;
    std::vector<TrackedPaths> pairs_;      // row per source
    std::vector<VoiceSlots> listeners_;    // slots per listener
    std::vector<std::uint64_t> found_at_;  // per source: the number at which its paths were found
    std::vector<double> harmonics_now_;

    std::size_t tail_length_ = 0;
    std::vector<RayOptions> ray_options_;  // per source
    std::optional<LateTails> tail_maker_;
    std::vector<std::shared_ptr<const audio::Tail>> tails_;  // per pair
    std::vector<std::uint64_t> late_at_;    // per source: the number at which it was renewed
    std::vector<std::uint64_t> late_work_;  // per source: reflections of the last time
    std::vector<CoherentLateSound> coherent_late_;  // per source; empty where rays are traced again
    UpdateCounts counts_;
};

}  // namespace earshot::propagation
