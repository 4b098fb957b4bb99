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

}  // namespace earshot::audio
