// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/fft.h"
#include "earshot/audio/internal/logical_lanes.h"
#include "earshot/base/large_array.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Bins of the spectrum of two blocks, padded.
constexpr std::size_t spectrum_stride(std::size_t block) noexcept {
    return padded(block + 1);
}

/// Transforms of two blocks in a row (overlap-save) between signals and spectra in single
/// precision: spectrum_stride() real parts, then as many imaginary ones. Allocates nothing after
/// its constructor.
class BlockTransform {
public:
    explicit BlockTransform(std::size_t block);

    std::size_t block() const noexcept { return fft_.size() / 2; }
    std::size_t stride() const noexcept { return spectrum_stride(block()); }

    /// The spectrum of `block` samples, the others 0. `count`: of them, at most a block.
    void forward_of_filter(const double* taps, std::size_t count, float* spectrum) noexcept;
    /// The spectrum of two blocks.
    void forward(const float* before, const float* now, float* spectrum) noexcept;
    /// The second of the two blocks of a spectrum.
    void inverse(const float* spectrum, float* signal) noexcept;

private:
    void split(float* spectrum) const noexcept;

    RealFft fft_;
    FftWorkspace workspace_;
    std::vector<double> window_;
    LargeArray<std::complex<double>> bins_;
};

}  // namespace earshot::audio
