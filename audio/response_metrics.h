// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/room_metrics.h"
#include "earshot/audio/speech.h"

#include <cstddef>
#include <optional>

namespace earshot::audio {

struct MetricsOptions {
    /// The response was measured: it ends in steady noise, which is estimated and taken out (ISO
    /// 3382-1:2009, 5.3.3; Lundeby et al. 1995). Decay times that the noise does not leave room
    /// for, 10 dB below their range, are empty.
    bool ends_in_noise = false;
    /// Values that noise or an early end may change by a just-noticeable difference are empty.
    bool withhold_uncertain = false;
    /// The response is known to hold the whole decay: it is not looked for signs that it was cut
    /// off.
    bool full_decay = false;
    /// Sample of the direct sound; looked for where it is not given.
    std::optional<std::size_t> onset{};
    /// For the speech transmission index.
    std::optional<SpeechConditions> speech{};
};

/// Metrics of a response, per band by zero-phase octave or third-octave filters, the onset of the
/// direct sound (20 dB below the largest sample) and backward integration (ISO 3382-1:2009, 5.3.3
/// and annex A). Ts counts from the onset; G takes a pressure of 1 as free field at 1 m. Every
/// value that is empty is explained in the notes; a silent response has none and one note. There
/// are no standard errors: the response is what it is.
RoomMetrics response_metrics(const Bands& bands,
                             const ImpulseResponse& response,
                             const MetricsOptions& options = {});
/// The same with filters that are kept.
RoomMetrics response_metrics(const Bands& bands,
                             const ImpulseResponse& response,
                             const MetricsOptions& options,
                             const FilterCache& cache);

}  // namespace earshot::audio
