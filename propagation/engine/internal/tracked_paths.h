// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_basis.h"
#include "earshot/propagation/engine/internal/voice_slots.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/unfolded_path.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A path of a pair from update to update.
struct TrackedPath {
    std::uint64_t id = 0;
    std::uint32_t slot = VoiceSlots::kNone;
    MovingUnfoldedPath unfolded{};
    std::vector<float> weights{};  ///< of the filters, at 1 m
    double level = 0.0;            ///< the loudest band's pressure
    double length = 0.0;           ///< metres, when it was found last
};

/// The paths of one pair, matched by what they meet (path_key()).
class TrackedPaths {
public:
    /// Those that were found at `time` (seconds of the sound). Appends the slots of paths that have
    /// ended to `ended`. Returns the largest error of a filter, see FilterBasis::add_weights().
    double follow(double time,
                  std::span<const Path> paths,
                  const FacetTable& facets,
                  const audio::FilterBasis& basis,
                  std::uint64_t& next_id,
                  std::vector<std::uint32_t>& ended);
    /// None of the paths goes on: source or listener has jumped.
    void end_all(std::vector<std::uint32_t>& ended);

    std::map<PathKey, TrackedPath>& paths() noexcept { return paths_; }
    const std::map<PathKey, TrackedPath>& paths() const noexcept { return paths_; }
    /// The sum of the squares of all levels.
    double energy() const noexcept { return energy_; }

private:
    double time_ = 0.0;  // at which they were found
    double energy_ = 0.0;
    std::map<PathKey, TrackedPath> paths_;
};

}  // namespace earshot::propagation
