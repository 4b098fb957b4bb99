// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/onset.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

std::optional<std::size_t> find_onset(std::span<const double> samples) {
    constexpr double kOnsetPressure = 0.1;
    double largest = 0.0;
    for (const double sample : samples) {
        largest = std::max(largest, std::abs(sample));
    }
    if (largest == 0.0) {
        return std::nullopt;
    }
    const auto onset = std::find_if(samples.begin(), samples.end(), [&](double sample) {
        return std::abs(sample) >= kOnsetPressure * largest;
    });
    return static_cast<std::size_t>(onset - samples.begin());
}

}  // namespace earshot::audio
