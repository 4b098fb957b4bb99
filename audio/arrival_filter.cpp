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

// Where a frequency lies among the band centres, on a logarithmic axis.
Place place_of(double frequency_hz, std::span<const double> centres) {
    if (frequency_hz <= centres.front()) {
        return {};
    }
    if (frequency_hz >= centres.back()) {
        return {centres.size() - 1, 0.0};
    }
    const auto above = std::upper_bound(centres.begin(), centres.end(), frequency_hz);
    const auto band = static_cast<std::size_t>(above - centres.begin()) - 1;
    const double weight =
        math::log(frequency_hz / centres[band]) / math::log(centres[band + 1] / centres[band]);
    return {band, weight};
}

}  // namespace

ArrivalFilter::ArrivalFilter(const Bands& bands, double sample_rate)
    : bands_in_use_(count_below_nyquist(bands, sample_rate)),
      fft_(filter_size(bands, sample_rate)),
      lower_band_(fft_.bins()),
      upper_weight_(fft_.bins()),
      phase_of_band_(bands_in_use_ * fft_.bins()) {
    EARSHOT_ASSERT(bands_in_use_ > 0);
    const auto centres = bands.exact_hz().first(bands_in_use_);
    const RealFft fine(kPhaseOversampling * fft_.size());
    std::vector<Place> places(fine.bins());
    for (std::size_t k = 0; k < fine.bins(); ++k) {
        const double cycles = static_cast<double>(k) / static_cast<double>(fine.size());
        places[k] = place_of(cycles * sample_rate, centres);
    }
    for (std::size_t k = 0; k < fft_.bins(); ++k) {
        lower_band_[k] = static_cast<std::uint8_t>(places[kPhaseOversampling * k].lower_band);
        upper_weight_[k] = places[kPhaseOversampling * k].upper_weight;
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
            phase_of_band_[band * fft_.bins() + k] = phase[kPhaseOversampling * k];
        }
    }
}

void ArrivalFilter::response(const Spectrum& pressure, std::span<Complex> spectrum) const {
    EARSHOT_ASSERT(spectrum.size() == fft_.bins());
    const auto used = std::span(pressure).first(bands_in_use_);
    const double largest = *std::max_element(used.begin(), used.end());
    EARSHOT_ASSERT(largest > 0.0);

    // One entry more than bands, so that the highest bins can read the band above with weight 0.
    std::array<double, kMaxBands + 1> log_pressure{};
    for (std::size_t band = 0; band < bands_in_use_; ++band) {
        log_pressure[band] = math::log(std::max(used[band] / largest, kPressureFloor));
    }
    // The constant part of a log-magnitude has no phase, so phases are taken relative to the
    // largest.
    std::vector<double> phase(fft_.bins(), 0.0);
    for (std::size_t band = 0; band < bands_in_use_; ++band) {
        const double weight = log_pressure[band];
        const double* row = &phase_of_band_[band * fft_.bins()];
        for (std::size_t k = 0; k < fft_.bins(); ++k) {
            phase[k] += weight * row[k];
        }
    }
    for (std::size_t k = 0; k < fft_.bins(); ++k) {
        const std::size_t band = lower_band_[k];
        const double log_magnitude =
            log_pressure[band] + upper_weight_[k] * (log_pressure[band + 1] - log_pressure[band]);
        const double magnitude = largest * math::exp(log_magnitude);
        spectrum[k] = {magnitude * math::cos(phase[k]), magnitude * math::sin(phase[k])};
    }
}

}  // namespace earshot::audio
