// SPDX-License-Identifier: MIT
#include "earshot/audio/spatial_metrics.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/correlation_kernel.h"
#include "earshot/audio/internal/onset.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::audio {

namespace {

constexpr double kLateralBegin = 0.005;  // seconds
constexpr double kEarlyEnd = 0.08;
constexpr double kMaxDelay = 0.001;  // between the ears

std::size_t samples_in(double time, double sample_rate) {
    return static_cast<std::size_t>(std::lround(time * sample_rate));
}

double energy_of(std::span<const double> signal) {
    return dot_product(signal, signal);
}

/// The ears' energies in a part of time, and their correlation with the right ear up to 1 ms
/// earlier or later.
struct Correlation {
    double left_energy = 0.0;
    double right_energy = 0.0;
    std::vector<double> by_shift{};  ///< the right ear by max_delay earlier first
};

Correlation correlation(std::span<const double> left,
                        std::span<const double> right,
                        std::size_t begin,
                        std::size_t end,
                        std::size_t max_delay) {
    Correlation result{.left_energy = energy_of(left.subspan(begin, end - begin)),
                       .right_energy = energy_of(right.subspan(begin, end - begin))};
    for (std::size_t shift = 0; shift <= 2 * max_delay; ++shift) {
        // Sample n of the left ear meets sample n + shift - max_delay of the right one.
        const std::size_t first = std::max(begin, max_delay - std::min(shift, max_delay));
        const std::size_t last = std::max(first, std::min(end, right.size() + max_delay - shift));
        result.by_shift.push_back(
            dot_product(left.subspan(first, last - first),
                        right.subspan(first + shift - max_delay, last - first)));
    }
    return result;
}

/// Of two parts of time together.
Correlation operator+(const Correlation& a, const Correlation& b) {
    Correlation sum = a;
    sum.left_energy += b.left_energy;
    sum.right_energy += b.right_energy;
    for (std::size_t shift = 0; shift < sum.by_shift.size(); ++shift) {
        sum.by_shift[shift] += b.by_shift[shift];
    }
    return sum;
}

// Nothing if an ear is silent then.
std::optional<double> coefficient(const Correlation& correlation) {
    const double energies = correlation.left_energy * correlation.right_energy;
    if (!(energies > 0.0)) {
        return std::nullopt;
    }
    double largest = 0.0;
    for (const double sum : correlation.by_shift) {
        largest = std::max(largest, std::abs(sum));
    }
    return largest / std::sqrt(energies);
}

MetricNote note_at(const char* metric, const Bands& bands, std::size_t band, const char* text) {
    return {.metric = metric, .band_hz = bands.nominal_hz()[band], .text = text};
}

}  // namespace

LateralMetrics lateral_metrics(const Bands& bands,
                               const ImpulseResponse& pressure,
                               const ImpulseResponse& figure_of_eight,
                               std::optional<std::size_t> onset) {
    return lateral_metrics(bands, pressure, figure_of_eight, onset, FilterCache());
}

LateralMetrics lateral_metrics(const Bands& bands,
                               const ImpulseResponse& pressure,
                               const ImpulseResponse& figure_of_eight,
                               std::optional<std::size_t> known_onset,
                               const FilterCache& cache) {
    EARSHOT_ASSERT(pressure.samples.size() == figure_of_eight.samples.size());
    EARSHOT_ASSERT(pressure.sample_rate == figure_of_eight.sample_rate);
    LateralMetrics metrics;
    metrics.lateral_fraction.resize(bands.count());
    const double rate = pressure.sample_rate;
    const auto onset = known_onset ? known_onset : find_onset(pressure.samples);
    const std::size_t early = samples_in(kEarlyEnd, rate);
    if (!onset || pressure.samples.size() - *onset < early) {
        metrics.notes.push_back(
            {.metric = "lf", .text = "silent, or it ends within 80 ms of the direct sound"});
        return metrics;
    }
    const BandEnergy of_pressure(bands, pressure.samples, rate, cache);
    const BandEnergy of_eight(bands, figure_of_eight.samples, rate, cache);
    const std::size_t begin = of_pressure.lead() + *onset;
    const std::size_t lateral = samples_in(kLateralBegin, rate);
    std::vector<double> omni, eight;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!of_pressure.covers(band)) {
            metrics.notes.push_back(
                note_at("lf", bands, band, "reaches past half the sample rate"));
            continue;
        }
        omni = of_pressure.filtered(band, std::move(omni));
        const double whole = energy_of(std::span(omni).first(begin + early));
        if (!(whole > 0.0)) {
            metrics.notes.push_back(note_at("lf", bands, band, "silent"));
            continue;
        }
        eight = of_eight.filtered(band, std::move(eight));
        metrics.lateral_fraction[band] =
            energy_of(std::span(eight).subspan(begin + lateral, early - lateral)) / whole;
    }
    return metrics;
}

BinauralMetrics binaural_metrics(const Bands& bands,
                                 const ImpulseResponse& left,
                                 const ImpulseResponse& right) {
    return binaural_metrics(bands, left, right, FilterCache());
}

BinauralMetrics binaural_metrics(const Bands& bands,
                                 const ImpulseResponse& left,
                                 const ImpulseResponse& right,
                                 const FilterCache& cache) {
    EARSHOT_ASSERT(left.samples.size() == right.samples.size());
    EARSHOT_ASSERT(left.sample_rate == right.sample_rate);
    const std::vector<std::optional<double>> none(bands.count());
    BinauralMetrics metrics{.iacc_early = none, .iacc_late = none, .iacc = none, .notes{}};
    const auto left_onset = find_onset(left.samples);
    const auto right_onset = find_onset(right.samples);
    const std::size_t early = samples_in(kEarlyEnd, left.sample_rate);
    if (!left_onset || !right_onset ||
        left.samples.size() - std::min(*left_onset, *right_onset) <= early) {
        metrics.notes.push_back(
            {.metric = "iacc",
             .text = "an ear is silent, or it ends within 80 ms of the direct sound"});
        return metrics;
    }
    const BandEnergy at_left(bands, left.samples, left.sample_rate, cache);
    const BandEnergy at_right(bands, right.samples, right.sample_rate, cache);
    const std::size_t begin = at_left.lead() + std::min(*left_onset, *right_onset);
    const std::size_t max_delay = samples_in(kMaxDelay, left.sample_rate);
    std::vector<double> l, r;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (!at_left.covers(band)) {
            metrics.notes.push_back(
                note_at("iacc", bands, band, "reaches past half the sample rate"));
            continue;
        }
        l = at_left.filtered(band, std::move(l));
        r = at_right.filtered(band, std::move(r));
        const Correlation at_first = correlation(l, r, begin, begin + early, max_delay);
        const Correlation later = correlation(l, r, begin + early, l.size(), max_delay);
        metrics.iacc_early[band] = coefficient(at_first);
        metrics.iacc_late[band] = coefficient(later);
        metrics.iacc[band] = coefficient(at_first + later);
        if (!metrics.iacc[band]) {
            metrics.notes.push_back(note_at("iacc", bands, band, "an ear is silent"));
        }
    }
    return metrics;
}

}  // namespace earshot::audio
