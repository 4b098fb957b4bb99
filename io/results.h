// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/propagation/simulator.h"

#include <optional>
#include <string>
#include <vector>

namespace earshot::io {

/// What paths.json and metrics.json say about the run as a whole.
struct ResultHeader {
    const propagation::Scene& scene;
    const audio::Bands& bands;
    double speed_of_sound = 0.0;  ///< metres per second
};

/// Metrics of one pair at one time, for metrics.json.
struct PairMetrics {
    std::size_t source = 0;
    std::size_t listener = 0;
    double time = 0.0;            ///< seconds
    audio::RoomMetrics metrics;   ///< of the response
    audio::RoomMetrics energy{};  ///< of the energies that arrive, see audio::energy_metrics
    std::optional<double> schroeder_hz{};
    std::optional<audio::LateralMetrics> lateral{};
    std::optional<audio::BinauralMetrics> binaural{};
};

/// The text of paths.json: one path per line, numbers with the fewest digits that read back as the
/// same double.
std::string encode_paths(const ResultHeader& header,
                         const std::vector<propagation::PairResult>& pairs);

/// The text of histograms.json: the late energy of each pair and its standard errors, band by band.
std::string encode_histograms(const ResultHeader& header,
                              const std::vector<propagation::PairResult>& pairs);

/// The text of metrics.json; a value that the response cannot support is null.
std::string encode_metrics(const ResultHeader& header, const std::vector<PairMetrics>& pairs);

/// The metrics of a sound file, a set per channel, as `earshot metrics --json` prints them: the
/// fields of metrics.json for each channel, and those of the channels together.
struct SoundMetrics {
    std::vector<audio::RoomMetrics> channels;
    std::optional<audio::LateralMetrics> lateral{};
    std::optional<audio::BinauralMetrics> binaural{};
};
std::string encode_sound_metrics(const std::string& file,
                                 double sample_rate,
                                 const audio::Bands& bands,
                                 const SoundMetrics& metrics);

}  // namespace earshot::io
