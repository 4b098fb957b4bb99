// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/noise_floor.h"

#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::audio {

namespace {

constexpr double kBlock = 0.01;       // seconds
constexpr double kAboveNoise = 10.0;  // 10 dB: the line is read above
constexpr double kNoiseShare = 0.1;   // of the response, at its end, at least
constexpr int kRounds = 5;
constexpr std::size_t kMinBlocks = 3;

/// Mean energies per sample of blocks.
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

/// Natural logarithm of the energy per sample, per block.
struct Line {
    double start = 0.0, slope = 0.0;
};

Line line_through(const std::vector<double>& blocks, std::size_t begin, std::size_t end) {
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
    const auto size = static_cast<std::size_t>(std::max(1.0, std::round(kBlock * sample_rate)));
    const std::vector<double> blocks = block_means(squared.subspan(onset), size);
    const auto last_tenth =
        static_cast<std::size_t>((1.0 - kNoiseShare) * static_cast<double>(blocks.size()));
    if (blocks.size() < 4 * kMinBlocks || last_tenth >= blocks.size()) {
        return {};
    }
    const auto loudest =
        static_cast<std::size_t>(std::max_element(blocks.begin(), blocks.end()) - blocks.begin());
    NoiseFloor floor;
    double noise = mean_from(blocks, last_tenth);
    for (int round = 0; round < kRounds; ++round) {
        if (!(noise > 0.0)) {
            return {};
        }
        std::size_t end = loudest;
        while (end < blocks.size() && blocks[end] >= kAboveNoise * noise) {
            ++end;
        }
        // What never comes down to the noise, or at once, has no decay that noise ends.
        if (end == blocks.size() || end < loudest + kMinBlocks) {
            return {};
        }
        const Line line = line_through(blocks, loudest, end);
        if (!(line.slope < 0.0)) {
            return {};
        }
        // In blocks; the line speaks for the middle of a block.
        const double meeting = (math::log(noise) - line.start) / line.slope;
        if (!(meeting < static_cast<double>(last_tenth))) {
            return {};
        }
        floor.energy = noise;
        floor.end = onset + static_cast<std::size_t>((meeting + 0.5) * static_cast<double>(size));
        floor.beyond = noise * static_cast<double>(size) / -line.slope;
        floor.depth_db = 10.0 * math::log10(blocks[loudest] / noise);
        const double beneath = meeting - math::log(kAboveNoise) / line.slope;
        noise = mean_from(blocks,
                          std::min(last_tenth, static_cast<std::size_t>(std::ceil(beneath)) + 1));
    }
    return floor;
}

}  // namespace earshot::audio
