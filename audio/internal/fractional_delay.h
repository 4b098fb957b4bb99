// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace earshot::audio {

/// Taps on either side of the delayed instant.
inline constexpr std::size_t kDelayHalfLength = 64;
inline constexpr std::size_t kDelayTaps = 2 * kDelayHalfLength;

/// A unit impulse that lies `fraction` (0 <= fraction < 1) of a sample past tap
/// kDelayHalfLength - 1, band-limited by a Kaiser-windowed sinc. The taps sum to 1; with
/// fraction 0 they are that one impulse exactly. Magnitude and delay are right within 2.5e-5 up to
/// 0.95 of half the sample rate (docs/algorithms/audio.md).
std::array<double, kDelayTaps> fractional_impulse(double fraction);

inline constexpr std::size_t kAllpassTaps = 256;

/// A unit impulse that lies `delay` samples past the first tap and has nothing before it: the
/// impulse response of Thiran's allpass filter (Laakso et al. 1996, section IV.B), which has
/// magnitude 1 at all frequencies (within 0.002 dB from a delay of 0.03 on, where the end of the
/// taps cuts it off) and a maximally flat delay at low ones. For delays too short for the ringing
/// ahead of fractional_impulse(). Precondition: 0 <= delay < kDelayHalfLength.
std::array<double, kAllpassTaps> allpass_impulse(double delay);

}  // namespace earshot::audio
