// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/audio/speech.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace earshot::io {

/// What metrics.json says about the run as a whole.
struct MetricsHeader {
    const propagation::Scene& scene;
    const audio::Bands& bands;
    std::optional<propagation::RoomStatistics> room{};
    std::optional<audio::SpeechConditions> speech{};
};

/// The text of metrics.json, a pair per line; a value that is not supported is null.
std::string encode_metrics(const MetricsHeader& header,
                           const std::vector<propagation::PairMetrics>& pairs);

/// The metrics of a sound file, a set per channel, as `earshot metrics --json` prints them: the
/// fields of metrics.json for each channel, and those of the channels together.
struct SoundMetrics {
    std::string file{};
    double sample_rate = 0.0;  ///< hertz
    std::optional<audio::SpeechConditions> speech{};
    std::vector<std::size_t> channel_numbers{};  ///< from 1, of each entry of `channels`
    std::vector<audio::RoomMetrics> channels{};
    std::optional<audio::LateralMetrics> lateral{};
    std::optional<audio::BinauralMetrics> binaural{};
};
std::string encode_sound_metrics(const audio::Bands& bands, const SoundMetrics& metrics);

}  // namespace earshot::io
