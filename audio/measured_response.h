// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/audio/metric_note.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// Samples that a recorder could not follow: those that equal the largest or the smallest of the
/// recording where three or more of them stand in a row, with a kink before or behind, or several
/// at full scale.
struct Clipping {
    std::size_t samples = 0;
    double level_db = 0.0;         ///< of the larger of the two extremes, decibels re a sample of 1
    double energy_share = 0.0;     ///< of the recording's energy
    double energy_after_db = 0.0;  ///< of what follows the last one, decibels re the whole
    /// A single sample stands at full scale: it is clipped, unless the recording was normalised.
    bool one_at_full_scale = false;
};
Clipping find_clipping(std::span<const double> samples);

/// A sound that arrives at least 0.1 s before the response proper and has less than a tenth of its
/// energy: harmonic distortion of a measurement with an exponential sweep (Farina 2000).
struct PreArrival {
    std::size_t onset = 0;  ///< sample
    double level_db = 0.0;  ///< of its energy re that of the response
};

/// Where the direct sound of a recording begins.
struct MeasuredOnset {
    std::size_t onset = 0;  ///< sample: the first less than 20 dB below the largest
    std::optional<PreArrival> pre_arrival{};
};
/// Nothing if all samples are 0. Precondition: sample_rate > 0.
std::optional<MeasuredOnset> find_measured_onset(std::span<const double> samples,
                                                 double sample_rate);

/// The part of a recording that is the response: without constant samples at its ends (padding), a
/// steady offset, and what precedes the direct sound by more than 10 ms (1 ms where it is given).
struct MeasuredResponse {
    ImpulseResponse response{};
    std::size_t begin = 0;  ///< sample of the recording that the response begins with
    std::size_t onset = 0;  ///< of the direct sound, a sample of the recording
    double offset = 0.0;    ///< what was subtracted
    Clipping clipping{};
    std::vector<MetricNote> notes{};  ///< what was left out, and clipping; metric "all"
};
/// Nothing if the recording is constant, or ends before `onset`. `onset`: a sample of the recording
/// where it is known, else it is looked for. Precondition: recording.sample_rate > 0.
std::optional<MeasuredResponse> measured_response(const ImpulseResponse& recording,
                                                  std::optional<std::size_t> onset = {});

/// The same part of another channel of the recording. Precondition: it has the recording's size.
ImpulseResponse same_part(const MeasuredResponse& part, const ImpulseResponse& channel);

}  // namespace earshot::audio
