// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/measured_metrics.h"
#include "earshot/io/measured_table.h"

#include <optional>
#include <vector>

namespace earshot::io {

struct MeasuredResponseOptions {
    audio::Bands bands = audio::Bands::octaves();
    /// Indices into audio::kBandMetricKinds; G needs a correction.
    std::vector<std::size_t> kinds{};
    bool noise_free = false;  ///< computed responses, without a noise floor
    /// See audio::calibrate_strength().
    std::optional<audio::StrengthCorrection> strength_correction_db{};
};

/// The metrics of recordings of impulse responses in a folder, named as `earshot ir` names them:
/// SOURCE__LISTENER.wav (or .flac, .ogg, .aiff), see ResultNames; of several channels the first. A
/// sound file of another name, clipping, and metrics that a recording does not support are
/// warnings. Throws Error if the folder holds no recording of a pair of the scene, for files that
/// cannot be read, and as ResultNames.
MeasuredMetrics read_measured_responses(const std::filesystem::path& folder,
                                        const propagation::Scene& scene,
                                        const MeasuredResponseOptions& options);

/// Either: a folder of recordings, or a table. Throws Error if there is neither.
MeasuredMetrics read_measured(const std::filesystem::path& folder_or_table,
                              const propagation::Scene& scene,
                              const MeasuredResponseOptions& options,
                              bool has_kinds);

}  // namespace earshot::io
