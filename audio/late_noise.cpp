// SPDX-License-Identifier: MIT
#include "earshot/audio/late_noise.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace earshot::audio {

namespace {

/// Noise of variance 1 per sample: velvet noise with the density of the reflections, and white
/// noise from the time on at which that density exceeds half the sample rate.
std::vector<double> velvet_then_white_noise(std::size_t length,
                                            double growth,
                                            double sample_rate,
                                            std::uint64_t seed) {
    std::vector<double> noise(length, 0.0);
    std::size_t white_begin = 0;
    if (growth > 0.0) {
        const double white_time = std::sqrt(0.5 * sample_rate / growth);
        white_begin = static_cast<std::size_t>(
            std::min(white_time * sample_rate, static_cast<double>(length)));
        // growth / 3 * t^3 reflections arrive before time t.
        const double count = growth / 3.0 * white_time * white_time * white_time;
        for (std::uint64_t k = 0; static_cast<double>(k) < count; ++k) {
            const double reflections_before = static_cast<double>(k) + random(seed, 1, k);
            const double time = math::pow(3.0 / growth * reflections_before, 1.0 / 3.0);
            const auto n = static_cast<std::size_t>(time * sample_rate);
            if (n < white_begin) {
                const double amplitude = std::sqrt(sample_rate / growth) / time;
                noise[n] += random(seed, 2, k) < 0.5 ? -amplitude : amplitude;
            }
        }
    }
    for (std::size_t n = white_begin; n < length; ++n) {
        noise[n] = std::sqrt(12.0) * (random(seed, 0, n) - 0.5);
    }
    return noise;
}

/// Shapes noise to the energy of histograms. The state depends only on the bands, the length and
/// the sample rate, so it serves several histograms.
class NoiseShaper {
public:
    NoiseShaper(const Bands& bands, std::size_t length, double sample_rate)
        : length_(length),
          sample_rate_(sample_rate),
          fft_(power_of_two_from(std::max<std::size_t>(length, 4))) {
        std::size_t count = 0;
        while (count < bands.count() && bands.exact_hz()[count] < 0.5 * sample_rate) {
            ++count;
        }
        std::vector<double> gain_sum(fft_.bins(), 0.0);
        for (std::size_t band = 0; band < count; ++band) {
            std::vector<double>& weights = band_weights_.emplace_back(fft_.bins());
            for (std::size_t k = 0; k < weights.size(); ++k) {
                weights[k] = band_power_gain(
                    bands,
                    band,
                    sample_rate * static_cast<double>(k) / static_cast<double>(fft_.size()));
                gain_sum[k] += weights[k];
            }
        }
        for (std::vector<double>& weights : band_weights_) {
            for (std::size_t k = 0; k < weights.size(); ++k) {
                weights[k] = gain_sum[k] > 0.0 ? weights[k] / gain_sum[k] : 0.0;
            }
        }
    }

    std::vector<double> noise(const EnergyHistogram& histogram, std::uint64_t seed) const {
        std::vector<double> white =
            velvet_then_white_noise(length_, histogram.reflection_growth, sample_rate_, seed);
        white.resize(fft_.size(), 0.0);
        std::vector<std::complex<double>> spectrum(fft_.bins());
        fft_.forward(white, spectrum);
        const double samples_per_bin = histogram.bin * sample_rate_;
        std::vector<double> sum(length_, 0.0);
        std::vector<double> signal(fft_.size());
        std::vector<std::complex<double>> band_spectrum(fft_.bins());
        for (std::size_t band = 0; band < band_weights_.size(); ++band) {
            for (std::size_t k = 0; k < band_spectrum.size(); ++k) {
                band_spectrum[k] = spectrum[k] * band_weights_[band][k];
            }
            fft_.inverse(band_spectrum, signal);
            for (std::size_t n = 0; n < length_; ++n) {
                const auto bin =
                    std::min(static_cast<std::size_t>(static_cast<double>(n) / samples_per_bin),
                             histogram.energy.size() - 1);
                sum[n] += signal[n] * std::sqrt(histogram.energy[bin][band] / samples_per_bin);
            }
        }
        return sum;
    }

private:
    std::size_t length_;
    double sample_rate_;
    RealFft fft_;
    std::vector<std::vector<double>> band_weights_;  // per band and bin; sum over bands: 1
};

std::size_t samples_of(const EnergyHistogram& histogram, double sample_rate) {
    return static_cast<std::size_t>(
        std::ceil(histogram.bin * sample_rate * static_cast<double>(histogram.energy.size())));
}

// Adds a part that begins at sample `begin`, without what comes before sample 0.
void add(std::span<const double> part,
         double gain,
         std::vector<double>& sum,
         std::ptrdiff_t begin = 0) {
    const auto skipped = static_cast<std::size_t>(std::max<std::ptrdiff_t>(-begin, 0));
    const auto first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(begin, 0));
    if (part.size() <= skipped) {
        return;
    }
    sum.resize(std::max(sum.size(), first + part.size() - skipped), 0.0);
    for (std::size_t n = skipped; n < part.size(); ++n) {
        sum[first + n - skipped] += gain * part[n];
    }
}

/// Calls visit(noise, direction) for each part of the sphere: its late noise, and the direction
/// that it arrives from as seen by the listener.
template <class Visit>
void for_each_part(const Bands& bands,
                   const EnergyHistogram& histogram,
                   double sample_rate,
                   std::uint64_t seed,
                   const Orientation& orientation,
                   const Visit& visit) {
    const std::size_t length = samples_of(histogram, sample_rate);
    if (length == 0) {
        return;
    }
    const NoiseShaper shaper(bands, length, sample_rate);
    for (std::size_t part = 0; part < kDirectionParts; ++part) {
        EnergyHistogram energy = energy_from(histogram, part);
        // The reflections are divided equally among the parts.
        energy.reflection_growth /= kDirectionParts;
        const auto middle = middle_of_part(part);
        const Arrival arrival{
            .delay = 0.0, .pressure = {}, .direction = {-middle[0], -middle[1], -middle[2]}};
        visit(shaper.noise(energy, random_bits(seed, part, 1)),
              origin_seen_from(orientation, arrival));
    }
}

}  // namespace

std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed) {
    const std::size_t length = samples_of(histogram, sample_rate);
    return length == 0 ? std::vector<double>{}
                       : NoiseShaper(bands, length, sample_rate).noise(histogram, seed);
}

std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation) {
    std::vector<std::vector<double>> channels(ambisonic_channels(order));
    std::vector<double> gains(channels.size());
    for_each_part(bands,
                  histogram,
                  sample_rate,
                  seed,
                  orientation,
                  [&](const std::vector<double>& noise, const std::array<double, 3>& from) {
                      spherical_harmonics(order, from, gains);
                      for (std::size_t channel = 0; channel < channels.size(); ++channel) {
                          add(noise, gains[channel], channels[channel]);
                      }
                  });
    return channels;
}

std::array<std::vector<double>, 2> binaural_late_noise(const Bands& bands,
                                                       const EnergyHistogram& histogram,
                                                       const HrirInterpolator& hrirs,
                                                       std::uint64_t seed,
                                                       const Orientation& orientation) {
    std::array<std::vector<double>, 2> ears;
    for_each_part(bands,
                  histogram,
                  hrirs.sample_rate(),
                  seed,
                  orientation,
                  [&](const std::vector<double>& noise, const std::array<double, 3>& from) {
                      const InterpolatedHrir hrir = hrirs.at(from);
                      for (std::size_t ear = 0; ear < 2; ++ear) {
                          add(convolve(noise, hrir.ears[ear]), 1.0, ears[ear], hrir.begin);
                      }
                  });
    return ears;
}

}  // namespace earshot::audio
