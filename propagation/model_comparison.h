// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::propagation {

/// One pair in two models of one room: means of the octaves 500 Hz and 1 kHz.
struct PairComparison {
    std::size_t source = 0;
    std::size_t listener = 0;
    std::size_t paths_before = 0, paths_after = 0;  ///< the direct one included
    audio::BandMetrics before{}, after{};
    audio::BandMetrics error_before{}, error_after{};  ///< standard errors
};

struct ModelComparison {
    std::vector<PairComparison> pairs;  ///< by source, then listener
    /// For preparing the scene and all pairs; without late rays, then with them.
    double path_seconds_before = 0.0, path_seconds_after = 0.0;
    double seconds_before = 0.0, seconds_after = 0.0;
};

/// The difference of a metric in just-noticeable differences, positive where it grew; empty where
/// one of the values is.
std::optional<double> noticeable_difference(const audio::BandMetricKind& kind,
                                            const audio::BandMetrics& before,
                                            const audio::BandMetrics& after);

/// Simulates both scenes with the same options. But for the seconds it depends on scenes and
/// options alone. Precondition: the same sources and listeners in both.
ModelComparison compare_models(const Scene& before,
                               const Scene& after,
                               const Options& options,
                               Executor& executor = Executor::serial(),
                               Progress* progress = nullptr);

}  // namespace earshot::propagation
