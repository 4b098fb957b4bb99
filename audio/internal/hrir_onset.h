// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/fft.h"

#include <cstddef>
#include <optional>
#include <span>

namespace earshot::audio {

/// Finds the onsets of responses up to `max_samples` long: where their magnitude, interpolated at
/// four times the sample rate, first passes a tenth of its maximum (-20 dB).
class OnsetFinder {
public:
    explicit OnsetFinder(std::size_t max_samples);

    /// In samples, with a fraction; none if the response is silent.
    std::optional<double> operator()(std::span<const double> response) const;

private:
    RealFft fft_;
    RealFft fine_fft_;
};

}  // namespace earshot::audio
