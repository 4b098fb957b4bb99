// SPDX-License-Identifier: MIT
#include "earshot/audio/late_noise.h"

#include "earshot/audio/convolve.h"
#include "earshot/audio/internal/filter_cache_state.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace earshot::audio {

namespace {

/// Adds noise of variance 1 per sample to silence: velvet noise with the density of the
/// reflections, and white noise from the time on at which that density exceeds half the sample
/// rate.
void velvet_then_white_noise(double growth,
                             double sample_rate,
                             std::uint64_t seed,
                             std::span<double> noise) {
    const std::size_t length = noise.size();
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
}

/// First sample of each interval of a histogram, and the number of samples.
std::vector<std::size_t> interval_begins(const EnergyHistogram& histogram,
                                         std::size_t length,
                                         double sample_rate) {
    const double samples_per_bin = histogram.bin * sample_rate;
    std::vector<std::size_t> begins = {0};
    for (std::size_t bin = 1; bin < histogram.energy.size(); ++bin) {
        // Sample n is in interval n / samples_per_bin, as rounded.
        const auto index = static_cast<double>(bin);
        auto n = static_cast<std::size_t>(std::ceil(index * samples_per_bin));
        while (n > 0 && static_cast<double>(n - 1) / samples_per_bin >= index) {
            --n;
        }
        while (static_cast<double>(n) / samples_per_bin < index) {
            ++n;
        }
        begins.push_back(std::min(n, length));
    }
    begins.push_back(length);
    return begins;
}

/// Shapes noise to the energy of histograms of one length.
class NoiseShaper {
public:
    NoiseShaper(const Bands& bands,
                const EnergyHistogram& histogram,
                std::size_t length,
                double sample_rate,
                const FilterCache& cache)
        : samples_per_bin_(histogram.bin * sample_rate),
          sample_rate_(sample_rate),
          begins_(interval_begins(histogram, length, sample_rate)),
          filters_(cache.state().complementary_filters.borrow(
              FilterKey(bands, sample_rate, power_of_two_from(std::max<std::size_t>(length, 4))))),
          workspace_(cache.state().workspaces.borrow()) {
        workspace_->spectrum.resize(filters_->fft().bins());
        workspace_->padded.resize(filters_->fft().size());
        workspace_->filtered.resize(filters_->fft().size());
    }

    /// Precondition: the histogram has the intervals of that which the object was made for.
    std::vector<double> noise(const EnergyHistogram& histogram, std::uint64_t seed) const {
        const std::size_t length = begins_.back();
        const std::span<double> white(workspace_->padded);
        std::fill(white.begin(), white.end(), 0.0);
        velvet_then_white_noise(
            histogram.reflection_growth, sample_rate_, seed, white.first(length));
        const RealFft& fft = filters_->fft();
        fft.forward(white, workspace_->spectrum, workspace_->fft);
        const std::span<double> signal(workspace_->filtered);
        std::vector<double> sum(length, 0.0);
        for (std::size_t band = 0; band < filters_->rows(); ++band) {
            fft.filtered_inverse(
                workspace_->spectrum, filters_->gains(band), signal, workspace_->fft);
            for (std::size_t bin = 0; bin + 1 < begins_.size(); ++bin) {
                const double amplitude = std::sqrt(histogram.energy[bin][band] / samples_per_bin_);
                for (std::size_t n = begins_[bin]; n < begins_[bin + 1]; ++n) {
                    sum[n] += signal[n] * amplitude;
                }
            }
        }
        return sum;
    }

private:
    double samples_per_bin_;
    double sample_rate_;
    std::vector<std::size_t> begins_;
    RecentlyUsed<ComplementaryFilters>::Loan filters_;
    WorkspacePool<FilterWorkspace>::Loan workspace_;
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
                   const FilterCache& cache,
                   const Visit& visit) {
    const std::size_t length = samples_of(histogram, sample_rate);
    if (length == 0) {
        return;
    }
    const NoiseShaper shaper(bands, histogram, length, sample_rate, cache);
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
    return late_noise(bands, histogram, sample_rate, seed, FilterCache());
}

std::vector<double> late_noise(const Bands& bands,
                               const EnergyHistogram& histogram,
                               double sample_rate,
                               std::uint64_t seed,
                               const FilterCache& cache) {
    const std::size_t length = samples_of(histogram, sample_rate);
    if (length == 0) {
        return {};
    }
    return NoiseShaper(bands, histogram, length, sample_rate, cache).noise(histogram, seed);
}

std::vector<std::vector<double>> band_noise(const Bands& bands,
                                            std::size_t length,
                                            double sample_rate,
                                            std::uint64_t seed,
                                            const FilterCache& cache) {
    const auto filters = cache.state().complementary_filters.borrow(
        FilterKey(bands, sample_rate, power_of_two_from(std::max<std::size_t>(length, 4))));
    const RealFft& fft = filters->fft();
    std::vector<double> noise(fft.size(), 0.0);
    velvet_then_white_noise(0.0, sample_rate, seed, std::span(noise).first(length));
    std::vector<std::complex<double>> spectrum(fft.bins());
    FftWorkspace workspace;
    fft.forward(noise, spectrum, workspace);
    std::vector<std::vector<double>> rows;
    for (std::size_t band = 0; band < filters->rows(); ++band) {
        fft.filtered_inverse(spectrum, filters->gains(band), noise, workspace);
        rows.emplace_back(noise.begin(), noise.begin() + static_cast<std::ptrdiff_t>(length));
    }
    return rows;
}

std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation) {
    return ambisonic_late_noise(
        bands, histogram, sample_rate, seed, order, orientation, FilterCache());
}

std::vector<std::vector<double>> ambisonic_late_noise(const Bands& bands,
                                                      const EnergyHistogram& histogram,
                                                      double sample_rate,
                                                      std::uint64_t seed,
                                                      int order,
                                                      const Orientation& orientation,
                                                      const FilterCache& cache) {
    std::vector<std::vector<double>> channels(ambisonic_channels(order));
    std::vector<double> gains(channels.size());
    for_each_part(bands,
                  histogram,
                  sample_rate,
                  seed,
                  orientation,
                  cache,
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
    return binaural_late_noise(bands, histogram, hrirs, seed, orientation, FilterCache());
}

std::array<std::vector<double>, 2> binaural_late_noise(const Bands& bands,
                                                       const EnergyHistogram& histogram,
                                                       const HrirInterpolator& hrirs,
                                                       std::uint64_t seed,
                                                       const Orientation& orientation,
                                                       const FilterCache& cache) {
    std::array<std::vector<double>, 2> ears;
    for_each_part(bands,
                  histogram,
                  hrirs.sample_rate(),
                  seed,
                  orientation,
                  cache,
                  [&](const std::vector<double>& noise, const std::array<double, 3>& from) {
                      const InterpolatedHrir hrir = hrirs.at(from);
                      for (std::size_t ear = 0; ear < 2; ++ear) {
                          add(convolve(noise, hrir.ears[ear]), 1.0, ears[ear], hrir.begin);
                      }
                  });
    return ears;
}

}  // namespace earshot::audio
