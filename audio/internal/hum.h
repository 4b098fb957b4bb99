// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <span>
#include <vector>

namespace earshot::audio {

/// Mains hum in a recording.
struct Hum {
    double mains_hz = 0.0;  ///< 50 or 60; 0: there is none
    /// The share of the steady noise's energy that is hum, per band, 0 ... 1.
    std::vector<double> noise_share{};
};

/// Finds steady lines at 50 or 60 Hz and its harmonics in the last two quarters of a response:
/// lines of its decay do not stay as loud. Precondition: sample_rate > 0.
Hum find_hum(const Bands& bands, std::span<const double> samples, double sample_rate);

}  // namespace earshot::audio
