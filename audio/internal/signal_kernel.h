// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/logical_lanes.h"

#include <cstddef>

namespace earshot::audio {

/// sum += a * b, of `count` complex numbers, a multiple of kLanes.
void add_product(const double* a, const double* b, std::size_t count, double* sum);

/// sum += factor * values.
void add_scaled(double factor, const double* values, std::size_t count, double* sum);

/// (1 - along) * low + along * high, of a multiple of kLanes numbers.
void interpolate(
    const double* low, const double* high, double along, std::size_t count, double* values);

/// trains[m * stride + n] += weights[m] * taps[n].
void spread(const double* taps,
            std::size_t tap_count,
            const double* weights,
            std::size_t train_count,
            std::size_t stride,
            double* trains);

/// Zeros that add_convolution() needs on both sides of the taps.
inline constexpr std::size_t kConvolutionMargin = 4 * kLanes;

/// sum[n + tap] += (factor * samples[n]) * taps[tap], ascending in n. `taps` has kConvolutionMargin
/// readable zeros before its first and after its last element, `sum` has count + tap_count - 1
/// numbers.
void add_convolution(double factor,
                     const double* samples,
                     std::size_t count,
                     const double* taps,
                     std::size_t tap_count,
                     double* sum);

}  // namespace earshot::audio
