// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/fft_kernel.h"
#include "earshot/base/large_array.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Memory for transforms of any size, kept from one to the next.
class FftWorkspace {
public:
    /// Arrays of `size` complex numbers each, of any contents.
    FftBuffers buffers(std::size_t size);

private:
    LargeArray<double> numbers_;
};

/// Discrete Fourier transform of real signals, the same bits on every x86-64 CPU and with any
/// instruction set. Const members may be called from many threads at once, each with a workspace of
/// its own.
class RealFft {
public:
    /// `size`: 2^k, 3 * 2^k or 5 * 2^k, and a multiple of 4.
    explicit RealFft(std::size_t size);

    std::size_t size() const noexcept { return size_; }
    std::size_t bins() const noexcept { return size_ / 2 + 1; }

    /// Bins 0 ... size/2 of sum_n signal[n] exp(-2 pi i k n / size).
    /// Precondition: signal.size() == size(), spectrum.size() == bins().
    void forward(std::span<const double> signal,
                 std::span<std::complex<double>> spectrum,
                 FftWorkspace& workspace) const;
    void forward(std::span<const double> signal, std::span<std::complex<double>> spectrum) const;

    /// The real signal with these bins, scaled by 1 / size so that it undoes forward(). The
    /// imaginary parts of the first and the last bin are taken as 0.
    /// Precondition: spectrum.size() == bins(), signal.size() == size().
    void inverse(std::span<const std::complex<double>> spectrum,
                 std::span<double> signal,
                 FftWorkspace& workspace) const;
    void inverse(std::span<const std::complex<double>> spectrum, std::span<double> signal) const;

    /// The same of a spectrum each bin of which is multiplied by a gain.
    /// Precondition: gains.size() == bins().
    void filtered_inverse(std::span<const std::complex<double>> spectrum,
                          std::span<const double> gains,
                          std::span<double> signal,
                          FftWorkspace& workspace) const;

private:
    FftPlan plan() const noexcept;

    std::size_t size_;
    std::vector<FftPass> passes_;
    LargeArray<double> factors_;  // of the passes, then of the half turn
};

/// Smallest power of two that is at least `min_size` (>= 1).
std::size_t power_of_two_from(std::size_t min_size) noexcept;

/// Smallest size of a RealFft that is at least `min_size` (>= 1).
std::size_t fft_size_from(std::size_t min_size) noexcept;

}  // namespace earshot::audio
