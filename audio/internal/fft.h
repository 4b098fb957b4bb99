// SPDX-License-Identifier: MIT
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

/// Discrete Fourier transform of real signals, the same bits on every x86-64 CPU. Const members may
/// be called from many threads at once.
class RealFft {
public:
    /// `size`: a power of two, at least 4.
    explicit RealFft(std::size_t size);
    ~RealFft();
    RealFft(RealFft&&) noexcept;
    RealFft& operator=(RealFft&&) noexcept;

    std::size_t size() const noexcept { return size_; }
    std::size_t bins() const noexcept { return size_ / 2 + 1; }

    /// Bins 0 ... size/2 of sum_n signal[n] exp(-2 pi i k n / size).
    /// Precondition: signal.size() == size(), spectrum.size() == bins().
    void forward(std::span<const double> signal, std::span<std::complex<double>> spectrum) const;

    /// The real signal with these bins, scaled by 1 / size so that it undoes forward(). The
    /// imaginary parts of the first and the last bin are taken as 0.
    /// Precondition: spectrum.size() == bins(), signal.size() == size().
    void inverse(std::span<const std::complex<double>> spectrum, std::span<double> signal) const;

private:
    struct Plans;  // keeps KISS FFT out of this header
    std::size_t size_;
    std::unique_ptr<const Plans> plans_;
    std::vector<std::complex<double>> half_turn_;  // exp(-2 pi i k / size), k < size / 2
};

/// Smallest power of two that is at least `min_size` (>= 1).
std::size_t power_of_two_from(std::size_t min_size) noexcept;

}  // namespace earshot::audio
