// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/listener_sums.h"

#include "earshot/base/math.h"
#include "earshot/base/standard_error.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace earshot::propagation {
namespace {

using audio::Spectrum;

/// The band whose centre is next to a frequency.
std::size_t band_at(const audio::Bands& bands, double frequency_hz) {
    std::size_t best = 0;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (std::abs(bands.nominal_hz()[band] - frequency_hz) <
            std::abs(bands.nominal_hz()[best] - frequency_hz)) {
            best = band;
        }
    }
    return best;
}

double decibels(double energy) {
    return 10.0 * math::log10(energy);
}

}  // namespace

std::vector<double> air_losses(const RayOptions& options, std::size_t bins) {
    const std::size_t bands = options.bands.count();
    std::vector<double> losses(bins * bands, 1.0);
    const double speed = speed_of_sound(options.air);
    for (std::size_t n = 0; options.air_absorption && n < bins; ++n) {
        const double travelled = (static_cast<double>(n) + 0.5) * options.bin * speed;
        const Spectrum air = air_pressure(options.air, options.bands, travelled);
        for (std::size_t band = 0; band < bands; ++band) {
            losses[n * bands + band] = air[band] * air[band];
        }
    }
    return losses;
}

ListenerSums::ListenerSums(const RayOptions& options,
                           std::span<const double> air_loss,
                           std::size_t listener,
                           std::size_t bins,
                           std::size_t direction_intervals,
                           std::size_t materials)
    : options_(options),
      listener_(listener),
      bins_(bins),
      direction_intervals_(direction_intervals),
      air_loss_(air_loss),
      energy_(bins * options.bands.count()),
      squares_(bins * options.bands.count()),
      replicates_(bins, options.bin, options.bands.count()),
      materials_(options, listener, bins, materials) {
    if (options.report_directions) {
        directions_.resize(direction_intervals * audio::kDirectionParts * options.bands.count());
    }
}

void ListenerSums::add(const BatchResult& batch, std::size_t rays) {
    const auto weight = static_cast<double>(rays);
    ++batches_;
    rays_ += weight;
    const double* energy = batch.energy.data() + listener_ * energy_.size();
    for (std::size_t i = 0; i < energy_.size(); ++i) {
        energy_[i] += weight * energy[i];
        squares_[i] += weight * (energy[i] * energy[i]);
    }
    replicates_.add({energy, energy_.size()}, air_loss_, weight);
    materials_.add(batch, weight);
    const double* directions = batch.directions.data() + listener_ * directions_.size();
    for (std::size_t i = 0; i < directions_.size(); ++i) {
        directions_[i] += weight * directions[i];
    }
}

audio::EnergyHistogram ListenerSums::histogram() const {
    const std::size_t bands = options_.bands.count();
    audio::EnergyHistogram result{.bin = options_.bin,
                                  .energy = std::vector<Spectrum>(bins_),
                                  .error = std::vector<Spectrum>(bins_)};
    const auto count = static_cast<double>(batches_);
    for (std::size_t n = 0; n < bins_; ++n) {
        for (std::size_t band = 0; band < bands; ++band) {
            const std::size_t i = n * bands + band;
            const double loss = air_loss(n, band);
            const double mean = energy_[i] / rays_;
            const double variance = std::max(0.0, squares_[i] / rays_ - mean * mean);
            result.energy[n][band] = loss * mean;
            result.error[n][band] = count > 1.0 ? loss * std::sqrt(variance / (count - 1.0)) : 0.0;
        }
    }
    if (options_.report_directions) {
        result.directions.resize(direction_intervals_);
        const double* from = directions_.data();
        for (auto& parts : result.directions) {
            for (Spectrum& part : parts) {
                std::transform(
                    from, from + bands, part.begin(), [&](double sum) { return sum / rays_; });
                from += bands;
            }
        }
    }
    return result;
}

LateErrors ListenerSums::errors() const {
    LateErrors result = errors_of(band_at(options_.bands, 500.0));
    const LateErrors other = errors_of(band_at(options_.bands, 1000.0));
    result.level_db = std::max(result.level_db, other.level_db);
    result.t30 = std::max(result.t30, other.t30);
    return result;
}

// The delta method: the line of T30 is a sum of levels with fixed weights, and so is its deviation
// in a replicate, to first order. Intervals of one replicate share rays, so their errors do not
// add.
LateErrors ListenerSums::errors_of(std::size_t band) const {
    LateErrors result{.rays = static_cast<std::size_t>(rays_)};
    const auto count = replicates_.count();
    if (count < 2) {
        return result;
    }
    // Backward sums (Schroeder), of each replicate and of their mean.
    const std::span<const std::size_t> first_bin = replicates_.first_bin();
    const std::size_t intervals = first_bin.size() - 1;
    std::vector<std::vector<double>> remaining(count, std::vector<double>(intervals));
    std::vector<double> mean(intervals);
    for (std::size_t replicate = 0; replicate < count; ++replicate) {
        double sum = 0.0;
        for (std::size_t n = intervals; n-- > 0;) {
            sum += replicates_.energy(replicate, n, band);
            remaining[replicate][n] = sum;
            mean[n] += sum / static_cast<double>(count);
        }
    }
    if (!(mean[0] > 0.0)) {
        return result;
    }
    const double factor = 10.0 / math::log(10.0);
    const auto error_of = [&](auto&& sum_over_levels) {
        std::vector<double> deviations;
        for (const std::vector<double>& decay : remaining) {
            deviations.push_back(sum_over_levels(
                [&](std::size_t n) { return factor * (decay[n] / mean[n] - 1.0); }));
        }
        return standard_error_of_mean(deviations);
    };
    result.level_db = error_of([](auto&& level_of) { return level_of(0); });

    // The line of T30 from -5 to -35 dB; an interval counts by its length.
    std::vector<std::size_t> range;
    double length = 0.0, centre = 0.0;
    const auto length_of = [&](std::size_t n) {
        return static_cast<double>(first_bin[n + 1] - first_bin[n]);
    };
    for (std::size_t n = 0; n < intervals && mean[n] > 0.0; ++n) {
        const double level = decibels(mean[n] / mean[0]);
        if (level <= -5.0 && level >= -35.0) {
            range.push_back(n);
            length += length_of(n);
            centre += length_of(n) * static_cast<double>(first_bin[n]);
        }
    }
    constexpr std::size_t kMinPoints = 3;
    if (range.size() < kMinPoints || range.back() + 1 == intervals) {
        return result;  // no decay of 35 dB
    }
    centre /= length;
    const auto slope_of = [&](auto&& level_of) {
        double slope = 0.0, spread = 0.0;
        for (const std::size_t n : range) {
            const double time = static_cast<double>(first_bin[n]) - centre;
            slope += length_of(n) * time * level_of(n);
            spread += length_of(n) * time * time;
        }
        return slope / spread;
    };
    const double slope = slope_of([&](std::size_t n) { return decibels(mean[n]); });
    result.t30 = error_of(slope_of) / std::abs(slope);
    return result;
}

}  // namespace earshot::propagation
