// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/decay_curve.h"

#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace earshot::audio {

namespace {

// Where a decay was cut off or thinned out, its curve bends down. The bend is looked for in steps
// of 10 dB, from the lower end of the range down to the depth that the longest range needs (T30
// with 10 dB to spare): a step bends if it takes less than a share of the time that the decay took
// so far per decibel. The share allows for the chance fluctuations of a decay in a narrow band,
// which go with 1 / sqrt(bandwidth * time) (Davy, Dunn and Dubout 1979). The three numbers are
// chosen over shoe-boxes and decaying noise: docs/algorithms/audio.md.
constexpr int kStepDb = 10;
constexpr int kLastStepFromDb = 45;
constexpr double kMinSlowness = 0.7;
constexpr double kFluctuation = 2.0;
constexpr double kMinSlownessOfAll = 0.3;

constexpr int kMaxDepthDb = kLastStepFromDb + kStepDb;

// Shorter decays are those of the filter (ISO 3382-2:2008, 7.3; Jacobsen 1987).
constexpr double kMinBandwidthTimesDecay = 16.0;

// Why a decay that bends at `depth_db` does not give a range.
std::string early_end(int depth_db, const DecayRange& range) {
    const int usable_db = depth_db - kStepDb;
    return usable_db < range.to_db ? "decay range " + std::to_string(usable_db) + " dB, " +
                                         std::to_string(range.to_db) + " dB needed"
                                   : "the decay bends " + std::to_string(depth_db) +
                                         " dB down: the response ends early";
}

std::string rounded_ms(double time) {
    return std::to_string(std::lround(1000.0 * time));
}

/// Energy from each sample on to the last, and `after` behind it. Every addition waits for the one
/// before it: eight sections are added up side by side, and each then gets what follows it.
void integrate_backward(std::span<const double> squared,
                        double after,
                        std::span<double> remaining) {
    constexpr std::size_t kSections = 8;
    const std::size_t length = squared.size() / kSections;
    std::array<double, kSections> sums{};
    for (std::size_t n = length; n-- > 0;) {
        for (std::size_t k = 0; k < kSections; ++k) {
            sums[k] += squared[k * length + n];
            remaining[k * length + n] = sums[k];
        }
    }
    double sum = after;
    for (std::size_t n = squared.size(); n-- > kSections * length;) {
        sum += squared[n];
        remaining[n] = sum;
    }
    for (std::size_t k = kSections; k-- > 0;) {
        for (std::size_t n = k * length; n < (k + 1) * length; ++n) {
            remaining[n] += sum;
        }
        sum = length > 0 ? remaining[k * length] : sum;
    }
}

}  // namespace

DecayCurve::DecayCurve(std::span<const double> squared,
                       std::size_t onset,
                       double sample_rate,
                       double tail_energy,
                       std::vector<double> memory)
    : sample_rate_(sample_rate), onset_(onset), integral_(std::move(memory)) {
    EARSHOT_ASSERT(onset < squared.size());
    integral_.resize(squared.size());
    integrate_backward(squared, tail_energy, integral_);
    energy_ = integral_.front();
    EARSHOT_ASSERT(energy_ > 0.0);

    // Ten decibels above the level at which the curve goes on by extrapolation it still shows the
    // chance of the few samples before.
    known_db_ = tail_energy > 0.0
                    ? static_cast<int>(-10.0 * math::log10(tail_energy / energy_)) - kStepDb
                    : kMaxDepthDb;
    const std::span<const double> curve = remaining();
    const double min_energy = energy_ * math::pow10(-kMaxDepthDb / 10.0);
    const auto end = static_cast<std::size_t>(
        std::find_if(
            curve.begin(), curve.end(), [&](double energy) { return energy < min_energy; }) -
        curve.begin());
    std::size_t sample = 0;
    for (int depth = 0; depth <= kMaxDepthDb; ++depth) {
        const double limit = energy_ * math::pow10(-depth / 10.0);
        while (sample < end && curve[sample] >= limit) {
            ++sample;
        }
        first_below_db_.push_back(sample);
    }
}

double DecayCurve::energy_from(double time) const noexcept {
    const auto sample = static_cast<std::size_t>(std::llround(time * sample_rate_));
    const std::span<const double> curve = remaining();
    return sample < curve.size() ? curve[sample] : 0.0;
}

// Time per decibel in the step after a depth, relative to that from the start down to it.
double DecayCurve::slowness_after(int depth_db) const noexcept {
    const auto at = [&](int depth) {
        return static_cast<double>(first_below_db_[static_cast<std::size_t>(depth)]);
    };
    const double next_step = (at(depth_db + kStepDb) - at(depth_db)) / kStepDb;
    const double so_far = at(depth_db) / depth_db;
    return so_far > 0.0 ? next_step / so_far : 0.0;
}

// For 60 dB, from when the curve enters the range and leaves it.
double DecayCurve::time_between(const DecayRange& range) const noexcept {
    const auto at = [&](int depth) {
        return static_cast<double>(first_below_db_[static_cast<std::size_t>(depth)]);
    };
    const double samples = at(range.to_db) - (range.from_db == 0 ? 0.0 : at(range.from_db));
    return 60.0 / (range.to_db - range.from_db) * samples / sample_rate_;
}

DecayCurve::Samples DecayCurve::samples_in(const DecayRange& range) const noexcept {
    return {range.from_db == 0 ? 0 : first_below_db_[static_cast<std::size_t>(range.from_db)],
            first_below_db_[static_cast<std::size_t>(range.to_db)]};
}

// Decibels per second, by least squares over the samples whose level is in the range; 0 if fewer
// than two are.
double DecayCurve::slope(const DecayRange& range) const noexcept {
    const auto [begin, end] = samples_in(range);
    if (end < begin + 2) {
        return 0.0;
    }
    const auto count = static_cast<double>(end - begin);
    const double time_squared = count * (count * count - 1.0) / 12.0;
    return kDbPerLogEnergy * log_covariance(remaining().subspan(begin, end - begin)) /
           time_squared * sample_rate_;
}

std::optional<double> DecayCurve::level_db(double energy) const noexcept {
    return energy > 0.0 ? std::optional(10.0 * math::log10(energy / energy_)) : std::nullopt;
}

std::optional<DecayLine> DecayCurve::line(const DecayRange& range) const {
    const double db_per_second = slope(range);
    if (!(db_per_second < 0.0)) {
        return std::nullopt;
    }
    const auto [begin, end] = samples_in(range);
    double sum_db = 0.0;
    for (const double energy : remaining().subspan(begin, end - begin)) {
        sum_db += 10.0 * math::log10(energy / energy_);
    }
    // The line goes through the mean of times and levels.
    const auto count = static_cast<double>(end - begin);
    const double mean_db = sum_db / count;
    const double mean_time = (static_cast<double>(begin) + 0.5 * (count - 1.0)) / sample_rate_;
    const auto at = [&](std::size_t sample) { return static_cast<double>(sample) / sample_rate_; };
    return DecayLine{.from = at(begin),
                     .to = at(end),
                     .level_from_db = mean_db + db_per_second * (at(begin) - mean_time),
                     .level_to_db = mean_db + db_per_second * (at(end) - mean_time)};
}

DecayCurve::Reading DecayCurve::read(const DecayRange& range,
                                     double bandwidth_hz,
                                     bool full_decay) const {
    const double db_per_second = slope(range);
    const double time = db_per_second < 0.0 ? -60.0 / db_per_second : 0.0;
    // A line through a few samples can be flatter than the decay that they are taken from.
    const double shortest = std::min(time, time_between(range));
    if (bandwidth_hz * shortest < kMinBandwidthTimesDecay) {
        return {std::nullopt,
                false,
                "decay of " + rounded_ms(shortest) + " ms, the band's filter needs " +
                    rounded_ms(kMinBandwidthTimesDecay / bandwidth_hz) + " ms"};
    }
    if (full_decay) {
        return {time, false, {}};
    }
    const double min_slowness =
        std::max(kMinSlowness - kFluctuation / std::sqrt(bandwidth_hz * time), kMinSlownessOfAll);
    const int last = std::min(kLastStepFromDb, known_db_ - kStepDb);
    for (int depth = range.to_db; depth <= last; ++depth) {
        if (slowness_after(depth) < min_slowness) {
            return {std::nullopt, true, early_end(depth, range)};
        }
    }
    return {time, false, {}};
}

}  // namespace earshot::audio
