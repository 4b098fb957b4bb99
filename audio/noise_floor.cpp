// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/noise_floor.h"

#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::audio {

namespace {

constexpr double kBlockTime = 0.01;     // seconds, of an averaging interval
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

double mean_from(const std::vector<double>& blocks, std::size_t begin) {
    double sum = 0.0;
    for (std::size_t k = begin; k < blocks.size(); ++k) {
        sum += blocks[k];
    }
    return sum / static_cast<double>(blocks.size() - begin);
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

}  // namespace

NoiseFloor find_noise_floor(std::span<const double> squared,
                            std::size_t onset,
                            double sample_rate) {
    const auto size = static_cast<std::size_t>(std::max(1.0, std::round(kBlockTime * sample_rate)));
    const std::vector<double> blocks = block_means(squared.subspan(onset), size);
    const auto tail_begin =
        static_cast<std::size_t>((1.0 - kMinNoiseShare) * static_cast<double>(blocks.size()));
    if (blocks.size() < 4 * kMinBlocks || tail_begin >= blocks.size()) {
        return {};
    }
    const auto loudest =
        static_cast<std::size_t>(std::max_element(blocks.begin(), blocks.end()) - blocks.begin());
    NoiseFloor floor;
    double noise = mean_from(blocks, tail_begin);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        if (!(noise > 0.0)) {
            return {};
        }
        std::size_t end = loudest;
        while (end < blocks.size() && blocks[end] >= kFitMargin * noise) {
            ++end;
        }
        // A signal that never falls to the noise, or falls to it at once, has no decay that ends in
        // noise.
        if (end == blocks.size() || end < loudest + kMinBlocks) {
            return {};
        }
        const DecayLine line = fit_line(blocks, loudest, end);
        if (!(line.slope < 0.0)) {
            return {};
        }
        // The cross point of decay and noise, in blocks. The line gives the energy in the middle of
        // a block.
        const double cross_point = (math::log(noise) - line.start) / line.slope;
        if (!(cross_point < static_cast<double>(tail_begin))) {
            return {};
        }
        floor.energy = noise;
        floor.cross_point =
            onset + static_cast<std::size_t>((cross_point + 0.5) * static_cast<double>(size));
        floor.tail_energy = noise * static_cast<double>(size) / -line.slope;
        floor.peak_to_noise_db = 10.0 * math::log10(blocks[loudest] / noise);
        const double noise_begin = cross_point - math::log(kFitMargin) / line.slope;
        noise = mean_from(
            blocks, std::min(tail_begin, static_cast<std::size_t>(std::ceil(noise_begin)) + 1));
    }
    return floor;
}

}  // namespace earshot::audio
