// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace earshot::audio {

/// A pass of a transform: butterflies of one radix, each of which combines `radix` numbers.
struct FftPass {
    std::size_t radix = 0;             ///< 2, 3, 4, 5 or 8
    std::size_t blocks = 0;            ///< groups of butterflies, each with its own twiddle factors
    std::size_t stride = 0;            ///< butterflies of a group
    const double* twiddles = nullptr;  ///< see append_twiddles(); none in the last
};

/// A transform of real signals of 2 * size samples by a complex one of `size` numbers: even samples
/// are real parts and odd ones imaginary parts.
struct FftPlan {
    std::size_t size = 0;
    std::span<const FftPass> passes{};  ///< from stride 1 on
    /// exp(-pi i k / size) for k <= size / 2.
    const double* half_turn_re = nullptr;
    const double* half_turn_im = nullptr;
};

/// Whether the first pass of a complex transform takes several butterflies at a time, which is
/// decided by its size alone and not by the CPU.
constexpr bool has_wide_first_pass(std::size_t size) noexcept {
    return size % 32 == 0;
}

/// Complex numbers as two arrays.
struct SplitComplex {
    double* re = nullptr;
    double* im = nullptr;
};

/// Room for two arrays of as many complex numbers as the plan's size.
struct FftBuffers {
    SplitComplex first{}, second{};
};

/// Bins 0 ... size as pairs of real and imaginary part.
void transform_real(const FftPlan& plan,
                    const double* signal,
                    const FftBuffers& buffers,
                    double* spectrum);

/// The signal of the spectrum times the gains (one per bin; none: 1), times `scale`.
void transform_to_real(const FftPlan& plan,
                       const double* spectrum,
                       const double* gains,
                       double scale,
                       const FftBuffers& buffers,
                       double* signal);

}  // namespace earshot::audio
