// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/measured_response.h"
#include "earshot/audio/response_metrics.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::audio {

/// Sample of the direct sound: the first less than 20 dB below the largest. Nothing if all are 0.
std::optional<std::size_t> direct_sound(const ImpulseResponse& response);

/// Per band, what is added to G of a response in which a sample of 1 would be the pressure in free
/// field at 1 m; empty for a band that has no calibration.
using StrengthCorrection = std::vector<std::optional<double>>;

/// Corrects G of every band; without a correction the response is not calibrated, and G is empty,
/// with a note. Precondition: the correction has a value per band.
void calibrate_strength(const Bands& bands,
                        const std::optional<StrengthCorrection>& correction_db,
                        RoomMetrics& metrics);

struct MeasuredOptions {
    /// Sample of the recording with which the direct sound begins; looked for where not given.
    std::optional<std::size_t> onset{};
    /// See calibrate_strength().
    std::optional<StrengthCorrection> strength_correction_db{};
    std::optional<SpeechConditions> speech{};
};

struct MeasuredMetrics {
    RoomMetrics metrics{};
    std::optional<MeasuredResponse> part{};  ///< what they are of; none of a silent recording
};

/// The metrics of a recording of an impulse response: of the part that is the response
/// (measured_response()), noise taken out (response_metrics()). Values that clipping changes are
/// empty, and a note names the bands whose noise is mains hum.
MeasuredMetrics measured_metrics(const Bands& bands,
                                 const ImpulseResponse& recording,
                                 const MeasuredOptions& options = {});

/// What to add to G of recordings of a source, per band, from a recording of the same source with
/// the same gain in free field at `distance` metres. Empty for a band in which that recording gives
/// no G. Precondition: distance > 0.
StrengthCorrection strength_correction_db(const Bands& bands,
                                          const ImpulseResponse& free_field,
                                          double distance);

/// The bass ratio BR, the mean reverberation time of 125 and 250 Hz over that of 500 Hz and 1 kHz:
/// of T30, or of T20 where a T30 is missing (Beranek 1962). Thirds count for the octave that they
/// make up. Nothing where a time is missing.
std::optional<double> bass_ratio(const Bands& bands, const RoomMetrics& metrics);

}  // namespace earshot::audio
