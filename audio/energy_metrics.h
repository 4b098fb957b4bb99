// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/room_metrics.h"
#include "earshot/audio/speech.h"

#include <optional>
#include <span>

namespace earshot::audio {

struct EnergyMetricsOptions {
    /// Of the late energy, for standard errors (jackknife); none with fewer than two. Must outlive
    /// the call.
    const HistogramReplicates* replicates = nullptr;
    /// For the speech transmission index.
    std::optional<SpeechConditions> speech{};
};

/// Metrics of the energies that arrive, on a grid of a tenth of a millisecond: what a response has
/// on average over small changes of place, without the interference of its arrivals, the chance of
/// its noise and the ringing of filters, as programs of geometrical room acoustics give them. The
/// onset is the first energy less than 20 dB below the largest of an instant in its band. The
/// octaves of STI are the bands, or the means of three thirds. Where twice the standard error of a
/// value exceeds its just-noticeable difference, the value is empty and a note tells the error.
RoomMetrics energy_metrics(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late,
                           const EnergyMetricsOptions& options = {});

}  // namespace earshot::audio
