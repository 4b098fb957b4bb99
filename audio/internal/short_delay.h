// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"

#include <cstddef>

namespace earshot::audio {

// Interpolation between samples that is short enough to be made for hundreds of arrivals while
// sound plays: up to 18 kHz at 48 kHz its error, and so every line that it adds to a tone whose
// delay changes, is 85 dB below the signal (docs/algorithms/audio.md). fractional_impulse() is the
// longer one for what is rendered in advance.

inline constexpr std::size_t kShortDelayTaps = 24;
/// Samples ahead of the instant that are read, and behind it one more.
inline constexpr std::size_t kShortDelayLead = kShortDelayTaps / 2 - 1;
/// Rows of taps between which interpolation is linear: an error of a tone of w radians per sample
/// of w^2 / 8 / 256^2 at most, 1e-5 at 18 kHz.
inline constexpr std::size_t kShortDelayFractions = 256;

class ShortDelayTable {
public:
    ShortDelayTable();
    /// The table that all may share.
    static const ShortDelayTable& shared();
    /// kShortDelayFractions + 1 rows of kShortDelayTaps: a sinc in Kaiser's window, whose taps sum
    /// to 1, at the fractions k / kShortDelayFractions.
    const float* rows() const noexcept { return rows_.data(); }

private:
    LargeArray<float> rows_;
};

}  // namespace earshot::audio
