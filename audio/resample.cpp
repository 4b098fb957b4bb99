// SPDX-License-Identifier: MIT
#include "earshot/audio/resample.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace earshot::audio {

namespace {

using Taps = std::array<double, kDelayTaps>;

constexpr auto kHalf = static_cast<std::int64_t>(kDelayHalfLength);

/// The impulses at fractions k / denominator of a sample, each made when it is first asked for.
class Impulses {
public:
    explicit Impulses(std::int64_t denominator) : denominator_(denominator) {}

    const Taps& at(std::int64_t numerator) {
        const auto [entry, is_new] = taps_.try_emplace(numerator);
        if (is_new) {
            entry->second = fractional_impulse(static_cast<double>(numerator) /
                                               static_cast<double>(denominator_));
        }
        return entry->second;
    }

private:
    std::int64_t denominator_;
    std::map<std::int64_t, Taps> taps_;
};

/// Every new sample is the sum of the old ones about it under an impulse at its instant.
void interpolate(std::span<const double> signal,
                 std::int64_t from,
                 std::int64_t to,
                 std::span<double> out) {
    Impulses impulses(to);
    const std::int64_t size = std::ssize(signal);
    for (std::int64_t n = 0; n < std::ssize(out); ++n) {
        const Taps& taps = impulses.at(n * from % to);
        const std::int64_t begin = n * from / to - (kHalf - 1);
        double sum = 0.0;
        for (std::int64_t k = std::max<std::int64_t>(begin, 0);
             k < std::min(begin + 2 * kHalf, size);
             ++k) {
            sum += taps[static_cast<std::size_t>(k - begin)] * signal[static_cast<std::size_t>(k)];
        }
        out[static_cast<std::size_t>(n)] = sum;
    }
}

/// Every old sample becomes an impulse that is band-limited at the new rate. There are from / to of
/// them to a new sample.
void decimate(std::span<const double> signal,
              std::int64_t from,
              std::int64_t to,
              std::span<double> out) {
    Impulses impulses(from);
    const double share = static_cast<double>(to) / static_cast<double>(from);
    for (std::int64_t k = 0; k < std::ssize(signal); ++k) {
        const Taps& taps = impulses.at(k * to % from);
        const std::int64_t begin = k * to / from - (kHalf - 1);
        const double sample = share * signal[static_cast<std::size_t>(k)];
        for (std::int64_t n = std::max<std::int64_t>(begin, 0);
             n < std::min(begin + 2 * kHalf, std::ssize(out));
             ++n) {
            out[static_cast<std::size_t>(n)] += taps[static_cast<std::size_t>(n - begin)] * sample;
        }
    }
}

}  // namespace

std::vector<double> resample(std::span<const double> signal,
                             std::int64_t from_hz,
                             std::int64_t to_hz) {
    EARSHOT_ASSERT(from_hz >= 1 && to_hz >= 1);
    const std::int64_t divisor = std::gcd(from_hz, to_hz);
    const std::int64_t from = from_hz / divisor;
    const std::int64_t to = to_hz / divisor;
    if (from == to) {
        return {signal.begin(), signal.end()};
    }
    const std::int64_t size = (std::ssize(signal) * to + from - 1) / from;
    std::vector<double> out(static_cast<std::size_t>(size), 0.0);
    if (from < to) {
        interpolate(signal, from, to, out);
    } else {
        decimate(signal, from, to, out);
    }
    return out;
}

}  // namespace earshot::audio
