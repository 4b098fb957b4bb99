// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/noise_floor.h"
#include "earshot/audio/room_metrics.h"

#include <span>
#include <string>
#include <vector>

namespace earshot::audio {

/// "31.5 Hz"
std::string band_name(const Bands& bands, std::size_t band);

/// Energy over time in one band of a response.
struct BandDecay {
    std::span<const double> squared;  ///< per sample; one is positive
    std::size_t onset = 0;            ///< < squared.size()
    double sample_rate = 0.0;         ///< hertz
    double after_onset = 0.0;         ///< seconds of sound, without what a filter adds to its end
    double reference = 1.0;           ///< energy of a free field at 1 m
    double bandwidth_hz = 0.0;        ///< of the filter
    NoiseFloor noise{};
    bool full_decay = false;  ///< the decay is known not to be cut off
};

/// Reads the metrics of band after band; what they lack is explained in `notes`.
class MetricsReader {
public:
    MetricsReader(const Bands& bands, std::vector<std::string>& notes)
        : bands_(bands), notes_(notes) {}

    /// Says which metrics so short a response cannot have.
    void note_extent(double after_onset);
    BandMetrics read(std::size_t band, const BandDecay& decay);
    /// To be called last: says which metrics are those of a decay that was cut off. True if the
    /// octaves of speech are.
    bool note_early_ends();

private:
    void read_times(const DecayCurve& curve,
                    const BandDecay& decay,
                    std::size_t band,
                    BandMetrics& out);
    std::optional<double> clarity_db(const DecayCurve& curve,
                                     double limit,
                                     const std::string& name_and_band);

    const Bands& bands_;
    std::vector<std::string>& notes_;
    bool any_ends_early_ = false;
    bool speech_ends_early_ = false;
};

}  // namespace earshot::audio
