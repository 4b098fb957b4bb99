// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/internal/fft.h"

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::audio {

/// A band whose pressure is further below the arrival's largest is taken to be this far below, so
/// that its logarithm exists. At -200 dB it is inaudible beside the loudest band.
inline constexpr double kPressureFloor = 1e-10;

/// Minimum-phase filters with given magnitudes at the band centres. Between centres the logarithm
/// of the magnitude is linear over the logarithm of the frequency; beyond the first and the last it
/// is held. Made once per bands and sample rate; const members may be called from many threads.
class ArrivalFilter {
public:
    ArrivalFilter(const Bands& bands, double sample_rate);

    const RealFft& fft() const noexcept { return fft_; }
    /// Bands whose centre lies below half the sample rate, counted from the lowest.
    std::size_t bands_in_use() const noexcept { return bands_in_use_; }

    /// The filter's transfer function at the bins of fft(), spectrum.size() == fft().bins().
    /// Precondition: pressures finite and >= 0, and at least one in use positive.
    void response(const Spectrum& pressure, std::span<std::complex<double>> spectrum) const;

private:
    std::size_t bands_in_use_;
    RealFft fft_;
    // Per bin: the band at or below it and the weight of the band above.
    std::vector<std::uint8_t> lower_band_;
    std::vector<double> upper_weight_;
    // Row per band: phase of the minimum-phase filter whose log-magnitude is that band's hat.
    std::vector<double> phase_of_band_;
};

}  // namespace earshot::audio
