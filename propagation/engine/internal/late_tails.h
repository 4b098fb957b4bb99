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
/// The field is diffuse: each harmonic has noise of its own.
class LateTails {
public:
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
    Settings settings_;
    std::vector<std::vector<std::vector<double>>> noise_;  // per channel and band
};

}  // namespace earshot::propagation
