// SPDX-License-Identifier: MIT
#include "earshot/audio/hrir_set.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace earshot::audio {

namespace {

std::size_t resampled_size(std::size_t size, double ratio) {
    return static_cast<std::size_t>(std::ceil(static_cast<double>(size) / ratio));
}

// The taps that make each sample at a higher rate, the same for all filters. `ratio`: old over new
// sample rate, at most 1.
class Upsampler {
public:
    Upsampler(double ratio, std::size_t max_samples) : ratio_(ratio) {
        for (std::size_t n = 0; n < resampled_size(max_samples, ratio); ++n) {
            const double position = static_cast<double>(n) * ratio;
            taps_.push_back(fractional_impulse(position - std::floor(position)));
        }
    }

    // The samples are those of a filter: more of them are each smaller.
    std::vector<double> operator()(std::span<const double> samples) const {
        std::vector<double> result(resampled_size(samples.size(), ratio_));
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
    double ratio_;
    std::vector<std::array<double, kDelayTaps>> taps_;
};

// What is put ahead of a filter at a lower rate, and so many samples after its end, hold all of the
// impulses that its samples become.
constexpr std::size_t kLead = kDelayHalfLength;

// The taps of each old sample at a lower rate. `ratio`: old over new sample rate, at least 1.
class Downsampler {
public:
    Downsampler(double ratio, std::size_t max_samples) : ratio_(ratio) {
        for (std::size_t k = 0; k < max_samples; ++k) {
            const double position = static_cast<double>(k) / ratio;
            taps_.push_back(fractional_impulse(position - std::floor(position)));
        }
    }

    // Every old sample becomes an impulse that is band-limited at the new rate: the gain at 0 Hz,
    // the sum of the samples, stays.
    std::vector<double> operator()(std::span<const double> samples) const {
        std::vector<double> result(resampled_size(samples.size(), ratio_) + 2 * kLead);
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const auto whole = static_cast<std::size_t>(static_cast<double>(k) / ratio_);
            // Tap kDelayHalfLength - 1 of the impulse is the whole sample, kLead after the start.
            const std::size_t begin = whole + kLead - (kDelayHalfLength - 1);
            for (std::size_t tap = 0; tap < kDelayTaps; ++tap) {
                result[begin + tap] += taps_[k][tap] * samples[k];
            }
        }
        return result;
    }

private:
    double ratio_;
    std::vector<std::array<double, kDelayTaps>> taps_;
};

template <class Resampler>
void resample_all(const Resampler& resample, HrirSet& set) {
    for (Hrir& direction : set.directions) {
        direction.left = resample(direction.left);
        direction.right = resample(direction.right);
    }
}

}  // namespace

HrirSet resampled(const HrirSet& set, double sample_rate) {
    EARSHOT_ASSERT(sample_rate > 0.0);
    HrirSet result = set;
    if (sample_rate == set.sample_rate) {
        return result;
    }
    std::size_t max_samples = 0;
    for (const Hrir& direction : set.directions) {
        max_samples = std::max({max_samples, direction.left.size(), direction.right.size()});
    }
    result.sample_rate = sample_rate;
    const double ratio = set.sample_rate / sample_rate;
    if (ratio < 1.0) {
        resample_all(Upsampler(ratio, max_samples), result);
    } else {
        resample_all(Downsampler(ratio, max_samples), result);
        result.centre_delay += static_cast<double>(kLead) / sample_rate;
    }
    return result;
}

}  // namespace earshot::audio
