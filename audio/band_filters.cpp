// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/band_filters.h"

#include "earshot/audio/internal/band_gain_kernel.h"

#include <cmath>

namespace earshot::audio {

namespace {

/// The low-pass prototype's frequency is (ratio - 1 / ratio) / width for a ratio of frequency and
/// centre: -1 and 1 at the band edges.
double prototype_width(const Bands& bands, std::size_t band) {
    const double edge = bands.upper_edge_hz(band) / bands.exact_hz()[band];
    return edge - 1.0 / edge;
}

std::size_t count_covered(const FilterKey& key) {
    std::size_t count = 0;
    while (count < key.bands->count() && key.bands->upper_edge_hz(count) <= key.sample_rate / 2.0) {
        ++count;
    }
    return count;
}

std::size_t count_centred(const FilterKey& key) {
    std::size_t count = 0;
    while (count < key.bands->count() && key.bands->exact_hz()[count] < 0.5 * key.sample_rate) {
        ++count;
    }
    return count;
}

}  // namespace

double band_power_gain(const Bands& bands, std::size_t band, double frequency_hz) noexcept {
    if (frequency_hz <= 0.0) {
        return 0.0;
    }
    const double ratio = frequency_hz / bands.exact_hz()[band];
    const double x = (ratio - 1.0 / ratio) / prototype_width(bands, band);
    const double x_squared = x * x;
    return 1.0 / (1.0 + x_squared * x_squared * x_squared);
}

FilterKey::FilterKey(const Bands& of, double rate, std::size_t transform_size)
    : bands(of.count() == Bands::octaves().count() ? &Bands::octaves() : &Bands::third_octaves()),
      sample_rate(rate),
      size(transform_size) {}

std::size_t GainTable::bytes() const noexcept {
    // The transform's factors are about as many numbers as it has samples.
    return sizeof(double) * (gains_.size() + fft_.size());
}

void GainTable::set_power_gains(std::size_t count) {
    rows_ = count;
    gains_.resize(count * fft_.bins());
    for (std::size_t band = 0; band < count; ++band) {
        compute_power_gains({.centre_hz = key_.bands->exact_hz()[band],
                             .width = prototype_width(*key_.bands, band),
                             .sample_rate = key_.sample_rate,
                             .size = static_cast<double>(key_.size)},
                            row(band));
    }
}

BandFilters::BandFilters(const FilterKey& key) : GainTable(key) {
    set_power_gains(count_covered(key));
    for (std::size_t band = 0; band < rows(); ++band) {
        const std::span<double> gains = row(band);
        // Parseval: every bin but the first, which is 0, and the last stands for two.
        double sum = 0.0;
        for (const double power : gains.first(gains.size() - 1)) {
            sum += 2.0 * power;
        }
        sum += gains.back();
        unit_impulse_energy_.push_back(sum / static_cast<double>(key.size));
        for (double& gain : gains) {
            gain = std::sqrt(gain);
        }
    }
}

ComplementaryFilters::ComplementaryFilters(const FilterKey& key) : GainTable(key) {
    set_power_gains(count_centred(key));
    std::vector<double> sum(fft().bins(), 0.0);
    for (std::size_t band = 0; band < rows(); ++band) {
        const std::span<const double> gains = row(band);
        for (std::size_t k = 0; k < sum.size(); ++k) {
            sum[k] += gains[k];
        }
    }
    for (std::size_t band = 0; band < rows(); ++band) {
        const std::span<double> gains = row(band);
        for (std::size_t k = 0; k < sum.size(); ++k) {
            gains[k] = sum[k] > 0.0 ? gains[k] / sum[k] : 0.0;
        }
    }
}

}  // namespace earshot::audio
