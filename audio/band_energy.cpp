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

double band_power_gain(const Bands& bands, std::size_t band, double frequency_hz) noexcept {
    if (frequency_hz <= 0.0) {
        return 0.0;
    }
    // The low-pass prototype's frequency, -1 and 1 at the edges.
    const double ratio = frequency_hz / bands.exact_hz()[band];
    const double edge = bands.upper_edge_hz(band) / bands.exact_hz()[band];
    const double x = (ratio - 1.0 / ratio) / (edge - 1.0 / edge);
    const double x_squared = x * x;
    return 1.0 / (1.0 + x_squared * x_squared * x_squared);
}

BandEnergy::BandEnergy(const Bands& bands, std::span<const double> signal, double sample_rate)
    : bands_(bands),
      sample_rate_(sample_rate),
      lead_(ringing_samples(bands, sample_rate)),
      squared_size_(signal.size() + 2 * lead_),
      fft_(power_of_two_from(std::max(std::size_t{4}, squared_size_))),
      spectrum_(fft_.bins()) {
    EARSHOT_ASSERT(!signal.empty() && sample_rate > 0.0);
    std::vector<double> padded(fft_.size(), 0.0);
    std::copy(signal.begin(), signal.end(), padded.begin() + static_cast<std::ptrdiff_t>(lead_));
    fft_.forward(padded, spectrum_);
}

bool BandEnergy::covers(std::size_t band) const noexcept {
    return bands_.upper_edge_hz(band) <= sample_rate_ / 2.0;
}

double BandEnergy::frequency_of_bin(std::size_t bin) const noexcept {
    return sample_rate_ * static_cast<double>(bin) / static_cast<double>(fft_.size());
}

std::vector<double> BandEnergy::filtered(std::size_t band) const {
    EARSHOT_ASSERT(covers(band));
    std::vector<std::complex<double>> spectrum(spectrum_);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        spectrum[k] *= std::sqrt(band_power_gain(bands_, band, frequency_of_bin(k)));
    }
    std::vector<double> signal(fft_.size());
    fft_.inverse(spectrum, signal);
    signal.resize(squared_size_);
    return signal;
}

std::vector<double> BandEnergy::squared(std::size_t band) const {
    std::vector<double> signal = filtered(band);
    for (double& sample : signal) {
        sample *= sample;
    }
    return signal;
}

double BandEnergy::of_unit_impulse(std::size_t band) const {
    EARSHOT_ASSERT(covers(band));
    // Parseval: every bin but the first and the last stands for two.
    double sum = 0.0;
    for (std::size_t k = 1; k + 1 < fft_.bins(); ++k) {
        sum += 2.0 * band_power_gain(bands_, band, frequency_of_bin(k));
    }
    sum += band_power_gain(bands_, band, sample_rate_ / 2.0);
    return sum / static_cast<double>(fft_.size());
}

}  // namespace earshot::audio
