// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/simulator.h"

#include <span>

namespace earshot::propagation {

/// Says why T30s (mean of 500 Hz and 1 kHz) are long compared with Eyring's: a note on "t30" for
/// each such pair, and of each source the note of its longest as a warning. The simulator
/// stands at the instant of `pairs`.
Warnings explain_long_decays(const Simulator& simulator,
                             const Scene& scene,
                             const RoomStatistics& room,
                             const RoomStatisticsOptions& options,
                             std::span<PairMetrics> pairs,
                             Executor& executor);

}  // namespace earshot::propagation
