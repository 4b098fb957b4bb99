// SPDX-License-Identifier: MIT
#include "earshot/propagation/decay_notes.h"

#include "earshot/propagation/long_decay.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

/// The expected T30; that of the response where the expected one is too uncertain to be told.
std::optional<double> t30_of(const PairMetrics& pair) {
    const auto& expected = pair.expected.mid.reverberation_time_t30;
    return expected ? expected : pair.response.mid.reverberation_time_t30;
}

}  // namespace

Warnings explain_long_decays(const Simulator& simulator,
                             const Scene& scene,
                             const RoomStatistics& room,
                             const RoomStatisticsOptions& options,
                             std::span<PairMetrics> pairs,
                             Executor& executor) {
    const double eyring = audio::mid_frequency_mean(options.bands, room.eyring);
    Warnings warnings;
    for (std::size_t source = 0; source < scene.sources.size(); ++source) {
        std::vector<PairMetrics*> of_source;
        const PairMetrics* longest = nullptr;
        for (PairMetrics& pair : pairs) {
            const std::optional<double> t30 = t30_of(pair);
            if (pair.source != source || !t30 || !(*t30 > kLongDecay * eyring)) {
                continue;
            }
            of_source.push_back(&pair);
            if (longest == nullptr || *t30 > *t30_of(*longest)) {
                longest = &pair;
            }
        }
        if (longest == nullptr) {
            continue;
        }
        const std::string cause =
            long_decay_cause(simulator.ray_scene(),
                             scene.position_at(scene.sources[source], longest->time),
                             *t30_of(*longest),
                             room,
                             options,
                             executor);
        for (PairMetrics* pair : of_source) {
            const std::string note = long_decay_note(*t30_of(*pair), eyring, cause);
            pair->expected.notes.push_back({.metric = "t30", .text = note});
            if (pair == longest) {
                warnings.push_back({scene.sources[source].name, note});
            }
        }
    }
    return warnings;
}

}  // namespace earshot::propagation
