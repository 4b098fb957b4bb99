// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/band_energy.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

namespace {

// What the narrowest filter rings beyond this many times 1 / bandwidth is 90 dB down in energy.
constexpr double kRingingTimesBandwidth = 6.0;

std::size_t ringing_samples(const Bands& bands, double sample_rate) {
    const double narrowest = bands.upper_edge_hz(0) - bands.lower_edge_hz(0);
    return static_cast<std::size_t>(std::ceil(kRingingTimesBandwidth / narrowest * sample_rate));
}

}  // namespace

BandEnergy::BandEnergy(const Bands& bands,
                       std::span<const double> signal,
                       double sample_rate,
                       const FilterCache& cache)
    : lead_(ringing_samples(bands, sample_rate)),
      squared_size_(signal.size() + 2 * lead_),
      filters_(cache.state().band_filters.borrow(
          FilterKey(bands, sample_rate, fft_size_from(squared_size_)))),
      workspace_(cache.state().workspaces.borrow()) {
    EARSHOT_ASSERT(!signal.empty() && sample_rate > 0.0);
    const RealFft& fft = filters_->fft();
    workspace_->spectrum.resize(fft.bins());
    workspace_->padded.resize(fft.size());
    workspace_->filtered.resize(fft.size());
    const auto begin = workspace_->padded.begin() + static_cast<std::ptrdiff_t>(lead_);
    std::fill(workspace_->padded.begin(), begin, 0.0);
    std::fill(std::copy(signal.begin(), signal.end(), begin), workspace_->padded.end(), 0.0);
    fft.forward(workspace_->padded, workspace_->spectrum, workspace_->fft);
}

std::span<const double> BandEnergy::filter(std::size_t band) const {
    EARSHOT_ASSERT(covers(band));
    filters_->fft().filtered_inverse(
        workspace_->spectrum, filters_->gains(band), workspace_->filtered, workspace_->fft);
    return std::span(workspace_->filtered).first(squared_size_);
}

std::vector<double> BandEnergy::filtered(std::size_t band, std::vector<double> memory) const {
    const std::span<const double> signal = filter(band);
    memory.assign(signal.begin(), signal.end());
    return memory;
}

std::vector<double> BandEnergy::squared(std::size_t band, std::vector<double> memory) const {
    const std::span<const double> signal = filter(band);
    memory.resize(signal.size());
    std::transform(signal.begin(), signal.end(), memory.begin(), [](double sample) {
        return sample * sample;
    });
    return memory;
}

double BandEnergy::of_unit_impulse(std::size_t band) const {
    EARSHOT_ASSERT(covers(band));
    return filters_->unit_impulse_energy(band);
}

}  // namespace earshot::audio
