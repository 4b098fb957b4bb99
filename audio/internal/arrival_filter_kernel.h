// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/logical_lanes.h"

#include <complex>
#include <cstddef>
#include <span>

namespace earshot::audio {

/// Consecutive bins between two band centres.
struct FilterSegment {
    std::size_t begin = 0, end = 0;
    std::size_t lower_band = 0;
};

/// What the kernels need of an ArrivalFilter; rows have `stride` entries, a multiple of kLanes.
struct FilterRows {
    std::size_t bands = 0;
    std::size_t stride = 0;
    std::span<const FilterSegment> segments{};
    const double* upper_weight = nullptr;   ///< per bin, of the band above
    const double* phase_of_band = nullptr;  ///< row per band
};

/// The transform of an impulse at a delay, see DelaySpectrum: exp(-i angle delay) (sum + kernel
/// difference).
struct SpectralDelay {
    double delay = 0.0;  ///< samples
    std::complex<double> sum{};
    std::complex<double> difference{};
};

/// Natural logarithms, in place. Precondition: `count` is a multiple of kLanes.
void logarithms(double* values, std::size_t count);

/// exp(sum over bands of log_pressure_b (hat_b + i phase_b)) per bin. `log_pressure` has an entry
/// more than bands; `log_magnitude` is scratch of stride + kLanes entries; `spectrum` gets 2 *
/// stride numbers, real and imaginary parts in turn.
void filter_spectrum(const FilterRows& rows,
                     const double* log_pressure,
                     double* log_magnitude,
                     double* spectrum);

/// Multiplies a spectrum of `count` bins, a multiple of kLanes, by that of a delayed impulse. Per
/// bin: `angle`, radians per sample, and `kernel`.
void delay_spectrum(const SpectralDelay& delay,
                    const double* angle,
                    const double* kernel,
                    std::size_t count,
                    double* spectrum);

}  // namespace earshot::audio
