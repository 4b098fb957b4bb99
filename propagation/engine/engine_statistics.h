// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace earshot::propagation {

/// What an engine has done so far.
struct EngineStatistics {
    std::uint64_t updates = 0;
    double median_update_milliseconds = 0.0;  ///< of the last 1,024 updates
    double max_update_milliseconds = 0.0;     ///< of all but the first, which prepares the scene
    std::uint64_t work = 0;                   ///< of the last update, see UpdateBudget
    std::size_t paths = 0;                    ///< after the last update, of all pairs
    /// Of all updates: paths without room (EngineOptions::max_paths, max_delay), sources whose
    /// paths were not sought for want of budget, late sound that was not traced or with fewer rays.
    std::uint64_t dropped_paths = 0, deferred_sources = 0, deferred_late = 0, reduced_late = 0;
    std::uint64_t failed_updates = 0;
    std::string last_failure{};
    /// The largest share of a path's pressure that the filters of the engine missed.
    double max_filter_error = 0.0;

    std::uint64_t blocks = 0;  ///< that were rendered
    /// Blocks at which the newest paths came after the time for which they were meant, so that
    /// motion was extrapolated: EngineOptions::motion_delay is too short if they are many.
    std::uint64_t late_snapshots = 0;
    std::uint64_t refused_calls = 0;  ///< of render(), which were answered with silence
    /// Blocks by the share of their duration that rendering took, in steps of 5 per cent; the last
    /// counts those that took longer. Empty where the processor has no time stamp counter.
    static constexpr std::size_t kLoadSteps = 20;
    std::array<std::uint64_t, kLoadSteps + 1> load{};

    /// The load that a share of all blocks (0 ... 1) did not exceed, in steps of 5 per cent.
    double load_quantile(double share) const noexcept;
};

}  // namespace earshot::propagation
