// SPDX-License-Identifier: MIT
#include "earshot/audio/binaural.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::audio {

namespace {

// Arrivals that are convolved before they are added up, in order: bounds the memory of a step.
constexpr std::size_t kArrivalsPerStep = 64;

constexpr double kMaxSamples = 2147483648.0;  // 2^31, as in Assembler

// One arrival at both ears, from sample `begin` on, which may be before the emission.
struct BinauralArrival {
    std::ptrdiff_t begin = 0;
    std::array<std::vector<double>, 2> ears;
};

BinauralArrival render_arrival(const Assembler& assembler,
                               Arrival arrival,
                               const HrirInterpolator& hrirs,
                               const Orientation& orientation,
                               double length) {
    const double rate = hrirs.sample_rate();
    if (!(arrival.delay >= 0.0 && arrival.delay * rate < kMaxSamples)) {
        // Throws, unless the arrival is past the end of a response of fixed length.
        assembler.assemble(std::span(&arrival, 1), length);
        return {};
    }
    std::array<double, 3> towards = origin_seen_from(orientation, arrival);
    if (towards == std::array<double, 3>{}) {
        towards = {1.0, 0.0, 0.0};
    }
    const InterpolatedHrir hrir = hrirs.at(towards);
    // Only the stretch about the arrival is filtered; an impulse begins before its time.
    const double begin = std::floor(arrival.delay * rate) - static_cast<double>(kDelayHalfLength);
    arrival.delay -= begin / rate;
    const std::vector<double> samples = assembler.assemble(std::span(&arrival, 1)).samples;
    BinauralArrival result;
    result.begin = static_cast<std::ptrdiff_t>(begin) + hrir.begin;
    for (std::size_t ear = 0; ear < 2; ++ear) {
        result.ears[ear] = convolve(samples, hrir.ears[ear]);
    }
    return result;
}

bool is_audible(const Arrival& arrival) {
    return std::any_of(
        arrival.pressure.begin(), arrival.pressure.end(), [](double p) { return p != 0.0; });
}

// Adds a part that begins at sample `begin`, without what comes before sample 0; a sum of fixed
// length ends where it ends.
void add(std::span<const double> part,
         std::ptrdiff_t begin,
         bool fixed_length,
         std::vector<double>& sum) {
    const auto skipped = static_cast<std::size_t>(std::max<std::ptrdiff_t>(-begin, 0));
    const auto first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(begin, 0));
    if (part.size() <= skipped) {
        return;
    }
    if (!fixed_length) {
        sum.resize(std::max(sum.size(), first + part.size() - skipped), 0.0);
    }
    for (std::size_t n = skipped; n < part.size() && first + n - skipped < sum.size(); ++n) {
        sum[first + n - skipped] += part[n];
    }
}

}  // namespace

std::array<ImpulseResponse, 2> render_binaural(const Assembler& assembler,
                                               std::span<const Arrival> arrivals,
                                               const HrirInterpolator& hrirs,
                                               const Orientation& orientation,
                                               double length,
                                               Executor& executor) {
    const ImpulseResponse silence = assembler.assemble({}, length);
    EARSHOT_ASSERT(silence.sample_rate == hrirs.sample_rate());
    std::array<ImpulseResponse, 2> ears{silence, silence};
    for (std::size_t first = 0; first < arrivals.size(); first += kArrivalsPerStep) {
        const auto step =
            arrivals.subspan(first, std::min(kArrivalsPerStep, arrivals.size() - first));
        std::vector<BinauralArrival> rendered(step.size());
        executor.for_each(step.size(), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (is_audible(step[i])) {
                    rendered[i] = render_arrival(assembler, step[i], hrirs, orientation, length);
                }
            }
        });
        for (const BinauralArrival& arrival : rendered) {
            for (std::size_t ear = 0; ear < 2; ++ear) {
                add(arrival.ears[ear], arrival.begin, length > 0.0, ears[ear].samples);
            }
        }
    }
    // The ears end together.
    const std::size_t size = std::max(ears[0].samples.size(), ears[1].samples.size());
    ears[0].samples.resize(size, 0.0);
    ears[1].samples.resize(size, 0.0);
    return ears;
}

}  // namespace earshot::audio
