// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/metric_note.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::audio {

/// Stage support (ISO 3382-1:2009, annex C) of a response 1 m from the source, decibels; per band,
/// and the mean of the octaves from 250 Hz to 2 kHz (or their thirds). Empty where the response
/// does not support it.
struct StageSupport {
    std::vector<std::optional<double>> early_db;  ///< ST_early: 20 to 100 ms over the first 10 ms
    std::vector<std::optional<double>> late_db;   ///< ST_late: 100 to 1000 ms over the first 10 ms
    std::optional<double> early_mean_db{};
    std::optional<double> late_mean_db{};
    std::vector<MetricNote> notes{};  ///< why a value is empty: st_early, st_late
};

/// `onset`: a sample of the response. Below 250 Hz the bands' filters ring for longer than 10 ms.
/// Precondition: onset < response.samples.size().
StageSupport stage_support(const Bands& bands,
                           const ImpulseResponse& response,
                           std::size_t onset,
                           bool ends_in_noise);

/// Late lateral sound level L_J (ISO 3382-1:2009, A.2.4): energy of the figure-of-eight from 80 ms
/// on re that of the source in free field at 10 m, decibels.
struct LateLateralLevel {
    std::vector<std::optional<double>> level_db;  ///< per band
    std::optional<double> mean_db{};  ///< of the energies of the octaves from 125 Hz to 1 kHz
    std::vector<MetricNote> notes{};  ///< why a value is empty: lj
};
/// `onset`: a sample of the response, of the direct sound in the pressure. `correction_db`: per
/// band, what is added to a level re free field at 1 m with pressure 1, as for G; without it there
/// are no values, and a note.
LateLateralLevel late_lateral_level(
    const Bands& bands,
    const ImpulseResponse& figure_of_eight,
    std::size_t onset,
    bool ends_in_noise,
    const std::optional<std::vector<std::optional<double>>>& correction_db);

}  // namespace earshot::audio
