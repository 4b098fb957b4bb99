// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/tail_convolver.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace earshot::propagation {

/// Makes late sound from energies: noise in bands, which is made once, under their envelopes. So
/// the tails of one source and different times are the same noise, and a fade from one to the next
/// is neither weaker nor louder than both. Those of several sources are shifted against each other.
/// Harmonics are sums of independent noises whose covariance is that of the directions from which
/// the energy comes, in each interval of the histogram's directions and band; without directions
/// the field is diffuse.
class LateTails {
public:
    static constexpr std::size_t kMaxChannels = 4;

    struct Settings {
        std::size_t channels = 1;  ///< harmonics: 1 or 4
        std::size_t sources = 1;
        std::size_t length = 0;  ///< samples
        std::size_t block = 256;
        double sample_rate = 48000.0;
        std::uint64_t seed = 1;
    };

    LateTails(const audio::Bands& bands, const Settings& settings);

    std::shared_ptr<const audio::Tail> make(const audio::EnergyHistogram& histogram,
                                            std::size_t source) const;

private:
    /// A bin of a histogram in a band.
    struct Interval {
        const audio::EnergyHistogram& histogram;
        std::size_t bin = 0, band = 0;
        std::size_t shift = 0;  // of the noise, samples
    };
    void add(const Interval& interval,
             double gain,
             const std::vector<double>& noise,
             std::vector<double>& tail) const;

    Settings settings_;
    std::vector<std::vector<std::vector<double>>> noise_;  // per channel and band
};

}  // namespace earshot::propagation
