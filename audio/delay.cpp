// SPDX-License-Identifier: MIT
#include "earshot/audio/delay.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

std::vector<double> delayed(std::span<const double> samples, double delay) {
    EARSHOT_ASSERT(std::isfinite(delay) && delay >= 0.0);
    const double floor = std::floor(delay);
    const auto whole = static_cast<std::size_t>(floor);
    std::vector<double> result(whole + samples.size(), 0.0);
    if (delay == floor) {
        std::copy(
            samples.begin(), samples.end(), result.begin() + static_cast<std::ptrdiff_t>(whole));
        return result;
    }
    result.resize(result.size() + kDelayHalfLength);
    const std::array<double, kDelayTaps> taps = fractional_impulse(delay - floor);
    for (std::size_t n = 0; n < samples.size(); ++n) {
        // The impulse of a sample is centred at its tap kDelayHalfLength - 1.
        for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
            const std::size_t shifted = whole + n + tap;
            if (shifted + 1 >= kDelayHalfLength) {
                result[shifted + 1 - kDelayHalfLength] += samples[n] * taps[tap];
            }
        }
    }
    return result;
}

}  // namespace earshot::audio
