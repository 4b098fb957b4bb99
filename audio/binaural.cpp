// SPDX-License-Identifier: MIT
#include "earshot/audio/binaural.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace earshot::audio {

namespace {

// `ratio`: old over new sample rate, at most 1. The samples are those of a filter: more of them are
// each smaller.
std::vector<double> interpolated(std::span<const double> samples, double ratio) {
    const auto size =
        static_cast<std::size_t>(std::ceil(static_cast<double>(samples.size()) / ratio));
    std::vector<double> result(size);
    for (std::size_t n = 0; n < size; ++n) {
        const double position = static_cast<double>(n) * ratio;
        const auto whole = static_cast<std::size_t>(position);
        const auto taps = fractional_impulse(position - std::floor(position));
        for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
            const std::size_t shifted = whole + tap;
            if (shifted + 1 >= kDelayHalfLength &&
                shifted + 1 - kDelayHalfLength < samples.size()) {
                result[n] += ratio * taps[tap] * samples[shifted + 1 - kDelayHalfLength];
            }
        }
    }
    return result;
}

void add(std::span<const double> part, std::vector<double>& sum) {
    sum.resize(std::max(sum.size(), part.size()));
    for (std::size_t n = 0; n < part.size(); ++n) {
        sum[n] += part[n];
    }
}

}  // namespace

HeadResponses resampled(const HeadResponses& head, double sample_rate) {
    if (!(sample_rate >= head.sample_rate)) {
        throw Error("head responses",
                    "have a higher sample rate than the result",
                    "ask for at least " + std::to_string(head.sample_rate) + " Hz");
    }
    HeadResponses result = head;
    if (sample_rate == head.sample_rate) {
        return result;
    }
    result.sample_rate = sample_rate;
    for (HeadResponse& direction : result.directions) {
        direction.left = interpolated(direction.left, head.sample_rate / sample_rate);
        direction.right = interpolated(direction.right, head.sample_rate / sample_rate);
    }
    return result;
}

std::size_t nearest_direction(const HeadResponses& head, const std::array<double, 3>& towards) {
    EARSHOT_ASSERT(!head.directions.empty());
    std::size_t nearest = 0;
    double largest = -2.0;
    for (std::size_t i = 0; i < head.directions.size(); ++i) {
        const auto& [x, y, z] = head.directions[i].towards;
        const double cosine = x * towards[0] + y * towards[1] + z * towards[2];
        if (cosine > largest) {
            largest = cosine;
            nearest = i;
        }
    }
    return nearest;
}

std::array<ImpulseResponse, 2> render_binaural(const Assembler& assembler,
                                               std::span<const Arrival> arrivals,
                                               const HeadResponses& head,
                                               const Orientation& orientation,
                                               double length,
                                               Executor& executor) {
    if (head.directions.empty()) {
        throw Error("head responses", "there are none", "read a SOFA file that has some");
    }
    std::vector<std::vector<Arrival>> from(head.directions.size());
    for (const Arrival& arrival : arrivals) {
        std::array<double, 3> towards = origin_seen_from(orientation, arrival);
        if (towards == std::array<double, 3>{}) {
            towards = {1.0, 0.0, 0.0};
        }
        from[nearest_direction(head, towards)].push_back(arrival);
    }
    const ImpulseResponse silence = assembler.assemble({}, length);
    std::array<ImpulseResponse, 2> ears{silence, silence};
    for (std::size_t i = 0; i < from.size(); ++i) {
        if (from[i].empty()) {
            continue;
        }
        const auto heard = assembler.assemble(from[i], length, executor);
        EARSHOT_ASSERT(heard.sample_rate == head.sample_rate);
        add(convolve(heard.samples, head.directions[i].left), ears[0].samples);
        add(convolve(heard.samples, head.directions[i].right), ears[1].samples);
    }
    const std::size_t size = length > 0.0
                                 ? silence.samples.size()
                                 : std::max(ears[0].samples.size(), ears[1].samples.size());
    ears[0].samples.resize(size);
    ears[1].samples.resize(size);
    return ears;
}

}  // namespace earshot::audio
