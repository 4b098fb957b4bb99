// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/arrival_filter.h"

#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/minimum_phase.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// Bin spacing over the width of the lowest band. 0.65 puts two bins or more between the lowest
// centres and lets the filter ring for 1.5 / width: 85 ms at 48 kHz in octaves, 0.34 s in thirds.
constexpr double kSpacingOverLowestWidth = 0.65;

// Leaves a filter its ringing beside the taps of its delay at the lowest sample rates.
constexpr std::size_t kMinSize = 8 * kDelayTaps;

// The phases are made on a grid this much finer, which moves the aliasing of the cepstrum (it falls
// off as 1 / n^2 because of the kinks at the band centres) below the phase error that matters.
constexpr std::size_t kPhaseOversampling = 4;

std::size_t count_below_nyquist(const Bands& bands, double sample_rate) {
    const auto centres = bands.exact_hz();
    const auto end = std::lower_bound(centres.begin(), centres.end(), sample_rate / 2.0);
    return static_cast<std::size_t>(end - centres.begin());
}

std::size_t filter_size(const Bands& bands, double sample_rate) {
    const double spacing =
        kSpacingOverLowestWidth * (bands.upper_edge_hz(0) - bands.lower_edge_hz(0));
    const auto size = static_cast<std::size_t>(std::ceil(sample_rate / spacing));
    return power_of_two_from(std::max(size, kMinSize));
}

struct Place {
    std::size_t lower_band = 0;
    double upper_weight = 0.0;  // of lower_band + 1
};

// From each band's centre to the next, on a logarithmic axis.
std::vector<double> log_distances(std::span<const double> centres) {
    std::vector<double> distances;
    for (std::size_t band = 0; band + 1 < centres.size(); ++band) {
        distances.push_back(math::log(centres[band + 1] / centres[band]));
    }
    return distances;
}

// Where a frequency lies among the band centres, on a logarithmic axis.
Place place_of(double frequency_hz,
               std::span<const double> centres,
               std::span<const double> distances) {
    if (frequency_hz <= centres.front()) {
        return {};
    }
    if (frequency_hz >= centres.back()) {
        return {centres.size() - 1, 0.0};
    }
    const auto above = std::upper_bound(centres.begin(), centres.end(), frequency_hz);
    const auto band = static_cast<std::size_t>(above - centres.begin()) - 1;
    return {band, math::log(frequency_hz / centres[band]) / distances[band]};
}

}  // namespace

ArrivalFilter::ArrivalFilter(const Bands& bands, double sample_rate)
    : bands_in_use_(count_below_nyquist(bands, sample_rate)),
      fft_(filter_size(bands, sample_rate)),
      stride_(padded(fft_.bins())),
      upper_weight_(stride_ + kLanes, 0.0),
      phase_of_band_(bands_in_use_ * stride_, 0.0) {
    EARSHOT_ASSERT(bands_in_use_ > 0);
    const auto centres = bands.exact_hz().first(bands_in_use_);
    const RealFft fine(kPhaseOversampling * fft_.size());
    const std::vector<double> distances = log_distances(centres);
    std::vector<Place> places(fine.bins());
    for (std::size_t k = 0; k < fine.bins(); ++k) {
        const double cycles = static_cast<double>(k) / static_cast<double>(fine.size());
        places[k] = place_of(cycles * sample_rate, centres, distances);
    }
    for (std::size_t k = 0; k < fft_.bins(); ++k) {
        const Place& place = places[kPhaseOversampling * k];
        if (segments_.empty() || segments_.back().lower_band != place.lower_band) {
            segments_.push_back({.begin = k, .end = k, .lower_band = place.lower_band});
        }
        segments_.back().end = k + 1;
        upper_weight_[k] = place.upper_weight;
    }
    for (const double centre : centres) {
        const double bin =
            std::floor(centre / sample_rate * static_cast<double>(fft_.size()) + 0.5);
        centre_bins_.push_back(static_cast<std::size_t>(bin));
    }
    std::vector<Complex> hat(fine.bins());
    for (std::size_t band = 0; band < bands_in_use_; ++band) {
        for (std::size_t k = 0; k < fine.bins(); ++k) {
            const Place& at = places[k];
            hat[k] = at.lower_band == band       ? 1.0 - at.upper_weight
                     : at.lower_band + 1 == band ? at.upper_weight
                                                 : 0.0;
        }
        const std::vector<double> phase = minimum_phase(fine, hat);
        for (std::size_t k = 0; k < fft_.bins(); ++k) {
            phase_of_band_[band * stride_ + k] = phase[kPhaseOversampling * k];
        }
    }
}

FilterRows ArrivalFilter::rows() const noexcept {
    return {.bands = bands_in_use_,
            .stride = stride_,
            .segments = segments_,
            .upper_weight = upper_weight_.data(),
            .phase_of_band = phase_of_band_.data()};
}

void ArrivalFilter::response(const Spectrum& pressure, std::span<Complex> spectrum) const {
    EARSHOT_ASSERT(spectrum.size() == fft_.bins());
    const auto used = std::span(pressure).first(bands_in_use_);
    const double largest = *std::max_element(used.begin(), used.end());
    EARSHOT_ASSERT(largest > 0.0);

    // One entry more than bands, so that the highest bins can read the band above with weight 0.
    // The constant part of a log-magnitude has no phase, so phases are taken relative to the
    // largest.
    std::array<double, kMaxBands + 1> log_pressure{};
    for (std::size_t band = 0; band < bands_in_use_; ++band) {
        log_pressure[band] = math::log(std::max(used[band] / largest, kPressureFloor));
    }
    LargeArray<double> scratch(stride_ + kLanes), pairs(2 * stride_);
    filter_spectrum(rows(), log_pressure.data(), scratch.data(), pairs.data());
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        spectrum[k] = {largest * pairs[2 * k], largest * pairs[2 * k + 1]};
    }
}

}  // namespace earshot::audio
