// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/internal/arrival_filter_kernel.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/base/large_array.h"

#include <complex>
#include <cstddef>
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
    /// For filter_spectrum().
    FilterRows rows() const noexcept;
    /// The bin next to the centre of each band in use.
    std::span<const std::size_t> centre_bins() const noexcept { return centre_bins_; }

    /// The filter's transfer function at the bins of fft(), spectrum.size() == fft().bins().
    /// Precondition: pressures finite and >= 0, and at least one in use positive.
    void response(const Spectrum& pressure, std::span<std::complex<double>> spectrum) const;

private:
    std::size_t bands_in_use_;
    RealFft fft_;
    std::size_t stride_;  // bins, padded
    std::vector<std::size_t> centre_bins_;
    std::vector<FilterSegment> segments_;
    LargeArray<double> upper_weight_;
    // Row per band: phase of the minimum-phase filter whose log-magnitude is that band's hat.
    LargeArray<double> phase_of_band_;
};

}  // namespace earshot::audio
