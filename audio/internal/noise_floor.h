// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace earshot::audio {

/// Where a decay sinks into steady noise.
struct NoiseFloor {
    double energy = 0.0;    ///< of the noise, per sample; 0: none was found
    std::size_t end = 0;    ///< first sample in which the noise is louder than the decay
    double beyond = 0.0;    ///< energy of the decay from there on, had it gone on alone
    double depth_db = 0.0;  ///< of the noise below the decay's loudest 10 ms
};

/// After Lundeby, Vigran, Bietz and Vorlaender 1995: a line through the decay above the noise is
/// followed to where they meet, and the noise is taken anew from behind there, a few times over.
/// `squared`: the band's squared signal, of which the last tenth is noise if there is any.
/// Precondition: onset < squared.size(), sample_rate > 0.
NoiseFloor find_noise_floor(std::span<const double> squared, std::size_t onset, double sample_rate);

}  // namespace earshot::audio
