// SPDX-License-Identifier: MIT
#include "earshot/audio/auralization.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/resample.h"

#include <algorithm>
#include <cstddef>

namespace earshot::audio {

void resample_to(std::int64_t sample_rate, Signal& signal, Executor& executor) {
    if (signal.sample_rate == sample_rate) {
        return;
    }
    executor.for_each(signal.channels.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t channel = first; channel < last; ++channel) {
            auto& samples = signal.channels[channel];
            samples = resample(samples, signal.sample_rate, sample_rate);
        }
    });
    signal.sample_rate = sample_rate;
}

bool channels_fit(const Signal& dry, const Signal& response) noexcept {
    const std::size_t receivers = response.channels.size();
    return dry.channels.size() == 1 || receivers == 1 || receivers == dry.channels.size();
}

Signal auralize(Signal dry, std::span<const Signal> responses, Executor& executor) {
    resample_to(responses.front().sample_rate, dry, executor);
    const std::size_t receivers = responses.front().channels.size();
    Signal wet{.sample_rate = dry.sample_rate};
    wet.channels.resize(std::max(dry.channels.size(), receivers));
    for (std::size_t channel = 0; channel < wet.channels.size(); ++channel) {
        std::vector<std::vector<double>> filters;
        for (const Signal& response : responses) {
            filters.push_back(response.channels[receivers == 1 ? 0 : channel]);
        }
        wet.channels[channel] = convolve_moving(
            dry.channels[dry.channels.size() == 1 ? 0 : channel], filters, executor);
    }
    return wet;
}

void add_scaled(const Signal& part, double scale, Signal& sum) {
    for (std::size_t channel = 0; channel < part.channels.size(); ++channel) {
        const auto& from = part.channels[channel];
        auto& to = sum.channels[channel];
        to.resize(std::max(to.size(), from.size()), 0.0);
        for (std::size_t n = 0; n < from.size(); ++n) {
            to[n] += scale * from[n];
        }
    }
}

}  // namespace earshot::audio
