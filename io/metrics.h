// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/audio/speech.h"
#include "earshot/audio/stage_support.h"
#include "earshot/propagation/pair_metrics.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <optional>
#include <span>
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

/// The metrics of a channel of a sound file.
struct ChannelMetrics {
    std::size_t channel = 0;  ///< from 1
    audio::RoomMetrics metrics{};
    std::optional<double> onset{};       ///< of the direct sound in the file, seconds
    std::optional<double> bass_ratio{};  ///< BR
    std::optional<audio::StageSupport> support{};
};

/// The metrics of a sound file, a set per channel, as `earshot metrics` tells them: the fields of
/// metrics.json for each channel, and those of the channels together.
struct SoundMetrics {
    std::string file{};
    double sample_rate = 0.0;  ///< hertz
    std::optional<audio::SpeechConditions> speech{};
    std::vector<ChannelMetrics> channels{};
    std::optional<audio::LateralMetrics> lateral{};
    std::optional<audio::LateLateralLevel> late_lateral{};
    std::optional<audio::BinauralMetrics> binaural{};
};

/// One file is an object, several are a list `files` of such objects. Precondition: not empty.
std::string encode_sound_metrics(const audio::Bands& bands, std::span<const SoundMetrics> files);

/// A table with a row per file, channel and band and a header (docs/files.md): what belongs to the
/// channel or to the file as a whole is repeated in each of its rows; a value that there is not is
/// an empty field.
std::string encode_metrics_table(const audio::Bands& bands, std::span<const SoundMetrics> files);

}  // namespace earshot::io
