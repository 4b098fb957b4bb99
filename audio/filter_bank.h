// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/audio/multi_convolver.h"
#include "earshot/base/floating_point.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Minimum-phase filters of many spectra, written as weighted sums of a few filters within
/// 1e-5 of each (the representatives of docs/algorithms/audio.md). A linear change of the weights
/// cross-fades the filters.
class FilterBank {
public:
    /// `spectra`: pressures per band, each finite and of one sign in all bands; only bands below
    /// half the assembler's sample rate count.
    FilterBank(const Assembler& assembler, std::span<const Spectrum> spectra);

    /// Filter 0 leaves the signal as it is: that of spectra whose bands are all alike.
    std::size_t filters() const noexcept { return taps_.size(); }
    std::span<const double> taps(std::size_t filter) const noexcept { return taps_[filter]; }
    /// One per filter.
    std::span<const double> weights(std::size_t spectrum) const noexcept {
        return std::span(weights_).subspan(spectrum * filters(), filters());
    }
    /// Plays the filters' buses: signal filter * channels + channel.
    MultiConvolver convolver(std::size_t channels, std::size_t block) const;

private:
    std::vector<std::vector<double>> taps_;
    std::vector<double> weights_;  // row per spectrum
};

}  // namespace earshot::audio
