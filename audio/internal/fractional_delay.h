// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/fft.h"
#include "earshot/base/large_array.h"

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace earshot::audio {

/// Taps on either side of the delayed instant.
inline constexpr std::size_t kDelayHalfLength = 64;
inline constexpr std::size_t kDelayTaps = 2 * kDelayHalfLength;

/// The modified Bessel function of order 0, of which Kaiser's window is made. Precondition: |x| is
/// at most kMaxBesselArgument.
double bessel_i0(double x) noexcept;
inline constexpr double kMaxBesselArgument = 11.0;

/// A unit impulse that lies `fraction` (0 <= fraction < 1) of a sample past tap
/// kDelayHalfLength - 1, band-limited by a Kaiser-windowed sinc. The taps sum to 1; with
/// fraction 0 they are that one impulse exactly. Magnitude and delay are right within 2.5e-5 up to
/// 0.95 of half the sample rate (docs/algorithms/audio.md).
std::array<double, kDelayTaps> fractional_impulse(double fraction);

/// Of the table's linear interpolation: an eighth of the squared spacing times the taps' curvature,
/// at most pi^2 / 3: 4e-7.
inline constexpr std::size_t kDelayFractions = 1024;

/// fractional_impulse() of any fraction from a table of them: linear between 1,025 fractions,
/// within 1e-6 per tap, and exact for fraction 0.
class DelayTable {
public:
    DelayTable();
    /// The table that all may share: it depends on nothing, and takes longer to make than a short
    /// response.
    static const DelayTable& shared();
    void impulse(double fraction, std::span<double, kDelayTaps> taps) const;
    /// kDelayFractions + 1 rows of kDelayTaps: the impulses of the fractions k / kDelayFractions.
    const double* rows() const noexcept { return rows_.data(); }

private:
    LargeArray<double> rows_;
};

/// The transforms of fractional_impulse() without a table: at the bins w of an FFT that of fraction
/// f is exp(-i w (63 + f)) (K0(w) + K1(w) exp(2 pi i f)), within 2e-6. K0 is the spectrum of the
/// continuous impulse and K1 what sampling folds onto it from above half the sample rate; their sum
/// is 1.
class DelaySpectrum {
public:
    explicit DelaySpectrum(const RealFft& fft);

    /// Multiplies a spectrum of fft.bins() bins, padded to a multiple of 8, by that of the impulse.
    void apply(double fraction, std::span<std::complex<double>> spectrum) const;

private:
    LargeArray<double> angle_;              // radians per sample, per bin
    LargeArray<double> kernel_difference_;  // K0 - K1 per bin
};

inline constexpr std::size_t kAllpassTaps = 256;

/// A unit impulse that lies `delay` samples past the first tap and has nothing before it: the
/// impulse response of Thiran's allpass filter (Laakso et al. 1996, section IV.B), which has
/// magnitude 1 at all frequencies (within 0.002 dB from a delay of 0.03 on, where the end of the
/// taps cuts it off) and a maximally flat delay at low ones. For delays too short for the ringing
/// ahead of fractional_impulse(). Precondition: 0 <= delay < kDelayHalfLength.
std::array<double, kAllpassTaps> allpass_impulse(double delay);

}  // namespace earshot::audio
