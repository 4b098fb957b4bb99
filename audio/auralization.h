// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::audio {

/// Channels of one sample rate.
struct Signal {
    std::int64_t sample_rate = 0;  ///< hertz
    std::vector<std::vector<double>> channels{};
};

/// Every channel by resample(), to `sample_rate`, hertz.
void resample_to(std::int64_t sample_rate, Signal& signal, Executor& executor = Executor::serial());

/// Whether a receiver of so many channels can be given to a recording: one of both has a single
/// channel, or they have the same number.
bool channels_fit(const Signal& dry, const Signal& response) noexcept;

/// What a receiver hears of a recording: each channel by convolve_moving() with the responses, in
/// order of time, at their sample rate. A single channel of either serves all of the other.
/// Preconditions: there is a response; all have one sample rate and number of channels, which fits.
Signal auralize(Signal dry,
                std::span<const Signal> responses,
                Executor& executor = Executor::serial());

/// Adds `part`, scaled, to the sum, whose channels grow to hold it. Preconditions: they have the
/// same sample rate and number of channels.
void add_scaled(const Signal& part, double scale, Signal& sum);

}  // namespace earshot::audio
