// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// A part of a straight line of level over time: that of a reverberation time, over the range of
/// the decay that it is fitted to.
struct DecayLine {
    double from = 0.0, to = 0.0;                    ///< seconds after the onset
    double level_from_db = 0.0, level_to_db = 0.0;  ///< of the line at these times

    /// Seconds for 60 dB. Precondition: the line falls.
    double reverberation_time() const noexcept {
        return 60.0 * (to - from) / (level_from_db - level_to_db);
    }
};

/// The decay of a band by backward integration, and the lines that decay times are read from.
struct BandDecayLines {
    /// Energy still to come, in decibels of the whole, at multiples of the step after the band's
    /// onset; it ends above DecayLineOptions::min_level_db. Empty in a silent band.
    std::vector<double> level_db{};
    /// Of EDT, T20 and T30; empty where the range holds fewer than two instants. A line may be
    /// there where the metric is not, which has more demands (energy_metrics()).
    std::optional<DecayLine> edt{}, t20{}, t30{};
};

struct DecayLineOptions {
    double step = 5e-3;           ///< seconds, > 0
    double min_level_db = -70.0;  ///< < 0
};

/// Per band, from the energies that energy_metrics() reads: the time of each line is the metric.
std::vector<BandDecayLines> decay_lines(const Bands& bands,
                                        std::span<const Arrival> arrivals,
                                        const EnergyHistogram& late,
                                        const DecayLineOptions& options = {});

}  // namespace earshot::audio
