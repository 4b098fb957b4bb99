// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/listener_sums.h"

#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

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

/// Standard error of a mean.
double standard_error(std::span<const double> values) {
    const auto count = static_cast<double>(values.size());
    double mean = 0.0;
    for (const double value : values) {
        mean += value / count;
    }
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return std::sqrt(squares / (count * (count - 1.0)));
}

}  // namespace

ListenerSums::ListenerSums(const RayOptions& options,
                           std::size_t listener,
                           std::size_t bins,
                           std::size_t spans)
    : options_(options),
      listener_(listener),
      bins_(bins),
      spans_(spans),
      energy_(bins * options.bands.count()),
      squares_(bins * options.bands.count()),
      watched_bands_{band_at(options.bands, 500.0), band_at(options.bands, 1000.0)} {
    const std::size_t bands = options.bands.count();
    air_loss_.assign(bins * bands, 1.0);
    const double speed = speed_of_sound(options.air);
    for (std::size_t n = 0; options.air_absorption && n < bins; ++n) {
        const double travelled = (static_cast<double>(n) + 0.5) * options.bin * speed;
        const Spectrum air = air_pressure(options.air, options.bands, travelled);
        for (std::size_t band = 0; band < bands; ++band) {
            air_loss_[n * bands + band] = air[band] * air[band];
        }
    }
    if (options.report_directions) {
        directions_.resize(spans * audio::kDirectionParts * bands);
    }
}

void ListenerSums::add(const RayTally& tally, std::size_t rays) {
    const std::size_t bands = options_.bands.count();
    const auto weight = static_cast<double>(rays);
    ++batches_;
    rays_ += weight;
    const double* energy = tally.energy.data() + listener_ * energy_.size();
    for (std::size_t i = 0; i < energy_.size(); ++i) {
        energy_[i] += weight * energy[i];
        squares_[i] += weight * (energy[i] * energy[i]);
    }
    const double* directions = tally.directions.data() + listener_ * directions_.size();
    for (std::size_t i = 0; i < directions_.size(); ++i) {
        directions_[i] += weight * directions[i];
    }
    for (std::size_t watched = 0; watched < decays_.size(); ++watched) {
        const std::size_t band = watched_bands_[watched];
        Decay& decay = decays_[watched].emplace_back();
        for (std::size_t n = 0; n < bins_; ++n) {
            decay[n * kIntervals / bins_] += air_loss(n, band) * energy[n * bands + band];
        }
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
        result.directions.resize(spans_);
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
    LateErrors result = errors_of(0);
    const LateErrors other = errors_of(1);
    result.level_db = std::max(result.level_db, other.level_db);
    result.t30 = std::max(result.t30, other.t30);
    return result;
}

// The delta method: the line of T30 is a sum of levels with fixed weights, and so is its deviation
// in a batch, to first order. Intervals of one batch share rays, so their errors do not add.
LateErrors ListenerSums::errors_of(std::size_t watched) const {
    const std::vector<Decay>& decays = decays_[watched];
    LateErrors result{.rays = static_cast<std::size_t>(rays_)};
    if (decays.size() < 2) {
        return result;
    }
    // Backward sums (Schroeder), of the mean and of each batch.
    const auto backward = [](Decay decay) {
        for (std::size_t n = kIntervals - 1; n-- > 0;) {
            decay[n] += decay[n + 1];
        }
        return decay;
    };
    Decay mean{};
    std::vector<Decay> remaining;
    for (const Decay& decay : decays) {
        remaining.push_back(backward(decay));
        for (std::size_t n = 0; n < kIntervals; ++n) {
            mean[n] += remaining.back()[n] / static_cast<double>(decays.size());
        }
    }
    if (!(mean[0] > 0.0)) {
        return result;
    }
    const double factor = 10.0 / math::log(10.0);
    std::vector<double> deviations;
    for (const Decay& decay : remaining) {
        deviations.push_back(factor * (decay[0] / mean[0] - 1.0));
    }
    result.level_db = standard_error(deviations);

    // The line of T30 from -5 to -35 dB.
    std::vector<std::size_t> range;
    double centre = 0.0;
    for (std::size_t n = 0; n < kIntervals && mean[n] > 0.0; ++n) {
        const double level = decibels(mean[n] / mean[0]);
        if (level <= -5.0 && level >= -35.0) {
            range.push_back(n);
            centre += static_cast<double>(n);
        }
    }
    constexpr std::size_t kMinPoints = 3;
    if (range.size() < kMinPoints || range.back() + 1 == kIntervals) {
        return result;  // no decay of 35 dB
    }
    centre /= static_cast<double>(range.size());
    double spread = 0.0;
    for (const std::size_t n : range) {
        spread += (static_cast<double>(n) - centre) * (static_cast<double>(n) - centre);
    }
    const auto slope_of = [&](auto&& level_of) {
        double slope = 0.0;
        for (const std::size_t n : range) {
            slope += (static_cast<double>(n) - centre) / spread * level_of(n);
        }
        return slope;
    };
    const double slope = slope_of([&](std::size_t n) { return decibels(mean[n]); });
    deviations.clear();
    for (const Decay& decay : remaining) {
        deviations.push_back(
            slope_of([&](std::size_t n) { return factor * (decay[n] / mean[n] - 1.0); }));
    }
    result.t30 = standard_error(deviations) / std::abs(slope);
    return result;
}

}  // namespace earshot::propagation
