// SPDX-License-Identifier: MIT
#include "earshot/audio/late_noise.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace earshot::audio {

namespace {

/// Of variance 1, as a spectrum.
std::vector<std::complex<double>> white_noise(const RealFft& fft,
                                              std::size_t length,
                                              std::uint64_t seed) {
    std::vector<double> noise(fft.size(), 0.0);
    for (std::size_t n = 0; n < length; ++n) {
        noise[n] = std::sqrt(12.0) * (random(seed, 0, n) - 0.5);
    }
    std::vector<std::complex<double>> spectrum(fft.bins());
    fft.forward(noise, spectrum);
    return spectrum;
}

}  // namespace

std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed) {
    const double samples_per_bin = histogram.bin * sample_rate;
    const auto length = static_cast<std::size_t>(
        std::ceil(samples_per_bin * static_cast<double>(histogram.energy.size())));
    if (length == 0) {
        return {};
    }
    std::size_t count = 0;
    while (count < bands.count() && bands.exact_hz()[count] < 0.5 * sample_rate) {
        ++count;
    }
    const RealFft fft(power_of_two_from(std::max<std::size_t>(length, 4)));
    const auto noise = white_noise(fft, length, seed);
    // What the bands' filters let through together, per bin of the transform.
    std::vector<double> together(fft.bins(), 0.0);
    const auto gain = [&](std::size_t band, std::size_t k) {
        return band_power_gain(
            bands, band, sample_rate * static_cast<double>(k) / static_cast<double>(fft.size()));
    };
    for (std::size_t band = 0; band < count; ++band) {
        for (std::size_t k = 0; k < together.size(); ++k) {
            together[k] += gain(band, k);
        }
    }
    std::vector<double> sum(length, 0.0);
    std::vector<double> signal(fft.size());
    std::vector<std::complex<double>> part(fft.bins());
    for (std::size_t band = 0; band < count; ++band) {
        for (std::size_t k = 0; k < part.size(); ++k) {
            part[k] = together[k] > 0.0 ? noise[k] * (gain(band, k) / together[k]) : 0.0;
        }
        fft.inverse(part, signal);
        for (std::size_t n = 0; n < length; ++n) {
            const auto bin =
                std::min(static_cast<std::size_t>(static_cast<double>(n) / samples_per_bin),
                         histogram.energy.size() - 1);
            sum[n] += signal[n] * std::sqrt(histogram.energy[bin][band] / samples_per_bin);
        }
    }
    return sum;
}

}  // namespace earshot::audio
