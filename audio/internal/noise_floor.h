// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace earshot::audio {

/// Below this level of a measured decay's start above its noise nothing is read from it: the 20 dB
/// that EDT needs (ISO 3382-1:2009, 5.3.3) and 5 for the chance by which the loudest 10 ms exceed
/// the mean in low bands.
inline constexpr double kMinPeakToNoiseDb = 25.0;

/// A response's energy over time in one band.
struct Recording {
    std::span<const double> squared;  ///< per sample
    std::size_t onset = 0;            ///< < squared.size()
    double sample_rate = 0.0;         ///< hertz, > 0
    double bandwidth_hz = 0.0;        ///< > 0
};

/// The stationary noise in which a decay ends.
struct NoiseFloor {
    double energy = 0.0;            ///< of the noise, per sample; 0: no noise was found
    std::size_t cross_point = 0;    ///< first sample in which the noise is louder than the decay
    double tail_energy = 0.0;       ///< of the extrapolated decay after the cross point
    double peak_to_noise_db = 0.0;  ///< level of the decay's loudest 10 ms above the noise
    /// Where no noise was found: of the extrapolated decay after the last sample; the largest
    /// double where the response does not decay.
    double missing_energy = 0.0;
};

/// The method of Lundeby, Vigran, Bietz and Vorlaender 1995: a line fitted to the decay above the
/// noise is extrapolated to its cross point with the noise, and the noise is estimated again from
/// the response after the cross point. These steps are iterated. If the response contains noise,
/// its last tenth is noise. Where a sound falls to a steady end so fast that there is no line, the
/// cross point is where it is 10 dB above the noise for the last time, and tail_energy is 0.
NoiseFloor find_noise_floor(const Recording& recording);

}  // namespace earshot::audio
