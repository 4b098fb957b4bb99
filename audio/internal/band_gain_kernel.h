// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace earshot::audio {

/// A band's filter at the bins of a transform.
struct BandGainOptions {
    double centre_hz = 0.0;
    double width = 0.0;  ///< of the band in the prototype's frequency
    double sample_rate = 0.0;
    double size = 0.0;  ///< of the transform
};

/// band_power_gain() at frequency k * sample_rate / size of each entry k, to the bit.
void compute_power_gains(const BandGainOptions& options, std::span<double> gains);

}  // namespace earshot::audio
