// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/noise_floor.h"

#include "earshot/audio/internal/decay_kernel.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace earshot::audio {

namespace {

constexpr double kBlockTime = 0.01;  // seconds, of an averaging interval
constexpr double kShortBlockTime = 0.0025;
constexpr double kSmoothingCells = 3.0;
constexpr double kFitMargin = 10.0;     // 10 dB: the line is fitted to the decay above the noise
                                        // by this energy ratio
constexpr double kMinNoiseShare = 0.1;  // the last tenth of the response is taken for noise
constexpr int kIterations = 5;
constexpr std::size_t kMinBlocks = 3;

/// The mean energy per sample of each block.
std::vector<double> block_means(std::span<const double> squared, std::size_t size) {
    std::vector<double> means;
    for (std::size_t begin = 0; begin + size <= squared.size(); begin += size) {
        double sum = 0.0;
        for (std::size_t n = begin; n < begin + size; ++n) {
            sum += squared[n];
        }
        means.push_back(sum / static_cast<double>(size));
    }
    return means;
}

double mean_of(const std::vector<double>& blocks, std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
        sum += blocks[k];
    }
    return sum / static_cast<double>(end - begin);
}

double mean_from(const std::vector<double>& blocks, std::size_t begin) {
    return mean_of(blocks, begin, blocks.size());
}

/// The natural logarithm of a decay's energy per sample, as a linear function of the block.
struct DecayLine {
    double start = 0.0, slope = 0.0;
};

/// The line through the blocks [begin, end) by least squares.
DecayLine fit_line(const std::vector<double>& blocks, std::size_t begin, std::size_t end) {
    const auto count = static_cast<double>(end - begin);
    const double middle = (count - 1.0) / 2.0;
    double mean = 0.0;
    double covariance = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
        const double level = math::log(blocks[k]);
        mean += level / count;
        covariance += (static_cast<double>(k - begin) - middle) * level;
    }
    const double slope = covariance / (count * (count * count - 1.0) / 12.0);
    return {mean - slope * (middle + static_cast<double>(begin)), slope};
}

/// The decibels by which the means of the last two quarters may differ if both are of noise: two
/// standard deviations of their difference besides 1 dB.
double steady_limit_db(double bandwidth_hz, double quarter) {
    return 1.0 + 2.0 * kDbPerLogEnergy * std::sqrt(2.0 / (bandwidth_hz * quarter));
}

/// The search in blocks of one size.
class NoiseSearch {
public:
    NoiseSearch(const Recording& recording, double block_time)
        : recording_(recording),
          size_(static_cast<std::size_t>(
              std::max(1.0, std::round(block_time * recording.sample_rate)))),
          blocks_(block_means(recording.squared.subspan(recording.onset), size_)),
          tail_begin_(static_cast<std::size_t>((1.0 - kMinNoiseShare) *
                                               static_cast<double>(blocks_.size()))),
          smoothing_(static_cast<std::size_t>(
              std::ceil(kSmoothingCells / (block_time * recording.bandwidth_hz)))) {
        loudest_ = static_cast<std::size_t>(std::max_element(blocks_.begin(), blocks_.end()) -
                                            blocks_.begin());
    }

    bool long_enough() const {
        return blocks_.size() >= 4 * kMinBlocks && tail_begin_ < blocks_.size();
    }

    /// The method of Lundeby et al., nothing if there is no decay with a line that ends in noise.
    std::optional<NoiseFloor> iterate() const {
        NoiseFloor floor;
        double noise = mean_from(blocks_, tail_begin_);
        for (int iteration = 0; iteration < kIterations; ++iteration) {
            const std::size_t end = noise > 0.0 ? end_of_decay(noise) : 0;
            // A signal that never falls to the noise, or falls to it at once, has no decay that
            // ends in noise.
            if (end == blocks_.size() || end < loudest_ + kMinBlocks) {
                return std::nullopt;
            }
            const DecayLine line = fit_line(blocks_, loudest_, end);
            if (!(line.slope < 0.0)) {
                return std::nullopt;
            }
            // The cross point of decay and noise, in blocks. The line gives the energy in the
            // middle of a block.
            const double cross_point = (math::log(noise) - line.start) / line.slope;
            if (!(cross_point < static_cast<double>(tail_begin_)) ||
                !is_steady_from(cross_point, line)) {
                return std::nullopt;
            }
            floor.energy = noise;
            floor.cross_point = sample_of(cross_point + 0.5);
            floor.tail_energy = noise * static_cast<double>(size_) / -line.slope;
            floor.peak_to_noise_db = peak_to_noise_db(noise);
            const double noise_begin = cross_point - math::log(kFitMargin) / line.slope;
            noise = mean_from(
                blocks_,
                std::min(tail_begin_, static_cast<std::size_t>(std::ceil(noise_begin)) + 1));
        }
        return floor;
    }

    /// Where the second half of the response is steady but no line leads to it: a sound that falls
    /// to the noise at once, or that hardly exceeds it.
    std::optional<NoiseFloor> without_line() const {
        const std::size_t half = blocks_.size() / 2;
        const std::size_t quarter = (blocks_.size() - half) / 2;
        const double noise = mean_from(blocks_, half);
        if (!(noise > 0.0) || quarter == 0) {
            return std::nullopt;
        }
        const double last = mean_from(blocks_, blocks_.size() - quarter);
        const double change_db =
            std::abs(10.0 * math::log10(last / mean_of(blocks_, half, half + quarter)));
        const double time = static_cast<double>(quarter * size_) / recording_.sample_rate;
        if (!(change_db <= steady_limit_db(recording_.bandwidth_hz, time))) {
            return std::nullopt;
        }
        NoiseFloor floor;
        floor.energy = noise;
        floor.cross_point = sample_of(static_cast<double>(end_of_decay(noise)));
        floor.peak_to_noise_db = peak_to_noise_db(noise);
        return floor;
    }

    /// The energy that the decay still has behind the last sample, by the line through all of it:
    /// more than any number if it does not decay.
    double missing_energy() const {
        if (loudest_ + kMinBlocks > blocks_.size()) {
            return std::numeric_limits<double>::max();
        }
        if (!std::all_of(blocks_.begin() + static_cast<std::ptrdiff_t>(loudest_),
                         blocks_.end(),
                         [](double energy) { return energy > 0.0; })) {
            return 0.0;
        }
        const DecayLine line = fit_line(blocks_, loudest_, blocks_.size());
        const double at_end =
            mean_from(blocks_,
                      blocks_.size() -
                          std::min(blocks_.size(), std::max<std::size_t>(smoothing_, kMinBlocks)));
        return line.slope < 0.0 ? at_end * static_cast<double>(size_) / -line.slope
                                : std::numeric_limits<double>::max();
    }

private:
    /// The first block from the loudest on that the noise leaves no margin for a fit, of the mean
    /// of so many as have independent values.
    std::size_t end_of_decay(double noise) const {
        std::size_t end = loudest_;
        while (end < blocks_.size() &&
               mean_of(blocks_, end, std::min(end + smoothing_, blocks_.size())) >=
                   kFitMargin * noise) {
            ++end;
        }
        return end;
    }

    /// Whether the blocks from one on are noise rather than the decay that goes on: they fall from
    /// their first half to their second by less than half of what the decay would.
    bool is_steady_from(double begin, const DecayLine& line) const {
        const auto first = std::min(static_cast<std::size_t>(std::ceil(begin)), tail_begin_);
        const std::size_t half = (blocks_.size() - first) / 2;
        if (half == 0) {
            return false;
        }
        const double fall = math::log(mean_of(blocks_, first, first + half) /
                                      mean_of(blocks_, first + half, first + 2 * half));
        return fall < 0.5 * -line.slope * static_cast<double>(half);
    }

    std::size_t sample_of(double block) const {
        return std::min(
            recording_.squared.size(),
            recording_.onset + static_cast<std::size_t>(block * static_cast<double>(size_)));
    }

    double peak_to_noise_db(double noise) const {
        return 10.0 * math::log10(blocks_[loudest_] / noise);
    }

    const Recording& recording_;
    std::size_t size_;  // samples of a block
    std::vector<double> blocks_;
    std::size_t tail_begin_;
    std::size_t smoothing_;  // blocks in the time of a few independent values of the band
    std::size_t loudest_ = 0;
};

}  // namespace

NoiseFloor find_noise_floor(const Recording& recording) {
    const NoiseSearch search(recording, kBlockTime);
    // A short decay has too few blocks for a line.
    const NoiseSearch fine(recording, kShortBlockTime);
    if (search.long_enough()) {
        if (const auto floor = search.iterate()) {
            return *floor;
        }
        if (const auto floor = fine.iterate()) {
            return *floor;
        }
        if (const auto floor = search.without_line()) {
            return *floor;
        }
    }
    NoiseFloor none;
    none.missing_energy = search.long_enough() ? search.missing_energy() : fine.missing_energy();
    return none;
}

}  // namespace earshot::audio
