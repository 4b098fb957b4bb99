// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/simulator.h"

#include <span>

namespace earshot::cli {

/// Says why T30s (mean of 500 Hz and 1 kHz) are long compared with Eyring's: a note on "t30" for
/// each such pair, and of each source the note of its longest as a warning. The simulator
/// stands at the instant of `pairs`.
Warnings explain_long_decays(const propagation::Simulator& simulator,
                             const propagation::Scene& scene,
                             const propagation::RoomStatistics& room,
                             const propagation::RoomStatisticsOptions& options,
                             std::span<propagation::PairMetrics> pairs,
                             Executor& executor);

}  // namespace earshot::cli
