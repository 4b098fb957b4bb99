// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_comparison.h"

#include "earshot/audio/energy_metrics.h"

#include <chrono>
#include <cmath>

namespace earshot::propagation {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Simulated {
    std::vector<PairResult> pairs;
    double path_seconds = 0.0;
    double seconds = 0.0;
};

Simulated simulate(const Scene& scene,
                   const Options& options,
                   Executor& executor,
                   Progress* progress) {
    Simulated result;
    Options of_paths = options;
    of_paths.rays = 0;
    auto start = std::chrono::steady_clock::now();
    Simulator(scene, of_paths, executor).run(executor, progress);
    result.path_seconds = seconds_since(start);
    start = std::chrono::steady_clock::now();
    result.pairs = Simulator(scene, options, executor).run(executor, progress);
    result.seconds = seconds_since(start);
    return result;
}

}  // namespace

std::optional<double> noticeable_difference(const audio::BandMetricKind& kind,
                                            const audio::BandMetrics& before,
                                            const audio::BandMetrics& after) {
    const std::optional<double> old_value = before.*kind.value;
    const std::optional<double> new_value = after.*kind.value;
    if (!old_value || !new_value) {
        return std::nullopt;
    }
    const double unit =
        kind.just_noticeable_difference * (kind.relative ? std::abs(*old_value) : 1.0);
    return unit > 0.0 ? std::optional((*new_value - *old_value) / unit) : std::nullopt;
}

ModelComparison compare_models(const Scene& before,
                               const Scene& after,
                               const Options& options,
                               Executor& executor,
                               Progress* progress) {
    const Simulated first = simulate(before, options, executor, progress);
    const Simulated second = simulate(after, options, executor, progress);
    ModelComparison comparison{.pairs = {},
                               .path_seconds_before = first.path_seconds,
                               .path_seconds_after = second.path_seconds,
                               .seconds_before = first.seconds,
                               .seconds_after = second.seconds};
    const auto metrics_of = [&](const PairResult& pair) {
        return audio::energy_metrics(
            options.bands, arrivals_of(pair), pair.late, {.replicates = &pair.late_replicates});
    };
    for (std::size_t i = 0; i < first.pairs.size(); ++i) {
        const audio::RoomMetrics old_metrics = metrics_of(first.pairs[i]);
        const audio::RoomMetrics new_metrics = metrics_of(second.pairs[i]);
        comparison.pairs.push_back({.source = first.pairs[i].source,
                                    .listener = first.pairs[i].listener,
                                    .paths_before = first.pairs[i].paths.size(),
                                    .paths_after = second.pairs[i].paths.size(),
                                    .before = old_metrics.mid,
                                    .after = new_metrics.mid,
                                    .error_before = old_metrics.standard_error.mid,
                                    .error_after = new_metrics.standard_error.mid});
    }
    return comparison;
}

}  // namespace earshot::propagation
