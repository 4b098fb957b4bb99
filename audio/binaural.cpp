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

// The taps that make each sample at another rate, the same for all signals. `ratio`: old over new
// sample rate, at most 1.
class Interpolator {
public:
    Interpolator(double ratio, std::size_t longest) : ratio_(ratio) {
        for (std::size_t n = 0; n < size_of(longest); ++n) {
            const double position = static_cast<double>(n) * ratio;
            taps_.push_back(fractional_impulse(position - std::floor(position)));
        }
    }

    // The samples are those of a filter: more of them are each smaller.
    std::vector<double> operator()(std::span<const double> samples) const {
        std::vector<double> result(size_of(samples.size()));
        for (std::size_t n = 0; n < result.size(); ++n) {
            const auto whole = static_cast<std::size_t>(static_cast<double>(n) * ratio_);
            for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
                const std::size_t shifted = whole + tap;
                if (shifted + 1 >= kDelayHalfLength &&
                    shifted + 1 - kDelayHalfLength < samples.size()) {
                    result[n] += ratio_ * taps_[n][tap] * samples[shifted + 1 - kDelayHalfLength];
                }
            }
        }
        return result;
    }

private:
    std::size_t size_of(std::size_t samples) const {
        return static_cast<std::size_t>(std::ceil(static_cast<double>(samples) / ratio_));
    }

    double ratio_;
    std::vector<std::array<double, kDelayTaps>> taps_;
};

// What both ears get of one arrival, from sample `begin` on.
struct HeardArrival {
    std::size_t begin = 0;
    std::array<std::vector<double>, 2> ears;
};

HeardArrival hear(const Assembler& assembler,
                  Arrival arrival,
                  const HrirSet& head,
                  const Orientation& orientation) {
    std::array<double, 3> towards = origin_seen_from(orientation, arrival);
    if (towards == std::array<double, 3>{}) {
        towards = {1.0, 0.0, 0.0};
    }
    const Hrir& response = head.directions[closest_direction(head, towards)];
    // Only the stretch about the arrival is filtered; an impulse begins before its time.
    const double start =
        std::floor(arrival.delay * head.sample_rate) - static_cast<double>(kDelayHalfLength);
    HeardArrival heard;
    heard.begin = start > 0.0 ? static_cast<std::size_t>(start) : 0;
    arrival.delay -= static_cast<double>(heard.begin) / head.sample_rate;
    const std::vector<double> samples = assembler.assemble(std::span(&arrival, 1)).samples;
    heard.ears[0] = convolve(samples, response.left);
    heard.ears[1] = convolve(samples, response.right);
    return heard;
}

void add(std::span<const double> part, std::size_t begin, std::vector<double>& sum) {
    for (std::size_t n = 0; n < part.size() && begin + n < sum.size(); ++n) {
        sum[begin + n] += part[n];
    }
}

}  // namespace

HrirSet resampled(const HrirSet& head, double sample_rate) {
    if (!(sample_rate >= head.sample_rate)) {
        throw Error("head responses",
                    "have a higher sample rate than the result",
                    "use at least " + std::to_string(head.sample_rate) + " Hz");
    }
    HrirSet result = head;
    if (sample_rate == head.sample_rate) {
        return result;
    }
    result.sample_rate = sample_rate;
    std::size_t longest = 0;
    for (const Hrir& direction : head.directions) {
        longest = std::max({longest, direction.left.size(), direction.right.size()});
    }
    const Interpolator interpolate(head.sample_rate / sample_rate, longest);
    for (Hrir& direction : result.directions) {
        direction.left = interpolate(direction.left);
        direction.right = interpolate(direction.right);
    }
    return result;
}

std::size_t closest_direction(const HrirSet& head, const std::array<double, 3>& towards) {
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
                                               const HrirSet& head,
                                               const Orientation& orientation,
                                               double length,
                                               Executor& executor) {
    if (head.directions.empty()) {
        throw Error("head responses", "there are none", "read a SOFA file that has some");
    }
    const ImpulseResponse silence = assembler.assemble({}, length);
    EARSHOT_ASSERT(silence.sample_rate == head.sample_rate);
    std::vector<HeardArrival> heard(arrivals.size());
    executor.for_each(arrivals.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            heard[i] = hear(assembler, arrivals[i], head, orientation);
        }
    });
    std::array<ImpulseResponse, 2> ears{silence, silence};
    std::size_t size = silence.samples.size();
    for (const HeardArrival& arrival : heard) {
        for (std::size_t ear = 0; ear < 2; ++ear) {
            size = std::max(size, arrival.begin + arrival.ears[ear].size());
        }
    }
    if (length > 0.0 || arrivals.empty()) {
        size = silence.samples.size();
    }
    for (std::size_t ear = 0; ear < 2; ++ear) {
        ears[ear].samples.resize(size, 0.0);
        for (const HeardArrival& arrival : heard) {
            add(arrival.ears[ear], arrival.begin, ears[ear].samples);
        }
    }
    return ears;
}

}  // namespace earshot::audio
