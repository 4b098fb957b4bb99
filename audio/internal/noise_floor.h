// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace earshot::audio {

/// The stationary noise in which a decay ends.
struct NoiseFloor {
    double energy = 0.0;            ///< of the noise, per sample; 0: no noise was found
    std::size_t cross_point = 0;    ///< first sample in which the noise is louder than the decay
    double tail_energy = 0.0;       ///< of the extrapolated decay after the cross point
    double peak_to_noise_db = 0.0;  ///< level of the decay's loudest 10 ms above the noise
};

/// The method of Lundeby, Vigran, Bietz and Vorlaender 1995: a line fitted to the decay above the
/// noise is extrapolated to its cross point with the noise, and the noise is estimated again from
/// the response after the cross point. These steps are iterated. `squared`: the band's squared
/// signal. If it contains noise, its last tenth is noise. Precondition: onset < squared.size(),
/// sample_rate > 0.
NoiseFloor find_noise_floor(std::span<const double> squared, std::size_t onset, double sample_rate);

}  // namespace earshot::audio
