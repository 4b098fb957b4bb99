// SPDX-License-Identifier: MIT
#include "earshot/audio/stage_support.h"

#include "earshot/audio/internal/band_course.h"
#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/decay_curve.h"
#include "earshot/audio/internal/metrics_reader.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace earshot::audio {

namespace {

// ISO 3382-1:2009, annex C, seconds.
constexpr double kDirectEnd = 0.01;
constexpr double kEarlyBegin = 0.02;
constexpr double kEarlyEnd = 0.1;
constexpr double kLateEnd = 1.0;

MetricNote note_at(const char* metric, const Bands& bands, std::size_t band, std::string text) {
    return {.metric = metric, .band_hz = bands.nominal_hz()[band], .text = std::move(text)};
}

/// A band's energy over time, or why it gives none.
struct CheckedCurve {
    std::optional<DecayCurve> curve{};
    double reference = 1.0;  // energy of a unit impulse
    std::string why_not{};
};

CheckedCurve curve_of(const Bands& bands,
                      std::size_t band,
                      const BandEnergy& energy,
                      const ImpulseResponse& response,
                      std::size_t onset,
                      bool ends_in_noise) {
    if (!energy.covers(band)) {
        return {.why_not = "the band reaches past half the sample rate"};
    }
    const BandCourse course = band_course(energy.squared(band),
                                          energy.lead(),
                                          bands.upper_edge_hz(band) - bands.lower_edge_hz(band),
                                          response,
                                          onset,
                                          ends_in_noise);
    if (std::all_of(
            course.squared.begin(), course.squared.end(), [](double e) { return e == 0.0; })) {
        return {.why_not = "silent"};
    }
    if (course.noise.energy > 0.0 && course.noise.peak_to_noise_db < kMinPeakToNoiseDb) {
        return {.why_not = "the noise is too loud"};
    }
    return {.curve = DecayCurve(
                course.squared, course.onset, response.sample_rate, course.noise.tail_energy),
            .reference = energy.of_unit_impulse(band)};
}

/// The mean over the bands whose nominal frequency is within the limits; nothing if one has no
/// value.
std::optional<double> mean_between(const Bands& bands,
                                   const std::vector<std::optional<double>>& values,
                                   double from_hz,
                                   double to_hz,
                                   const std::function<double(double)>& scale) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        if (bands.nominal_hz()[band] > from_hz && bands.nominal_hz()[band] < to_hz) {
            if (!values[band]) {
                return std::nullopt;
            }
            sum += scale(*values[band]);
            count += 1.0;
        }
    }
    return sum / count;
}

std::optional<double> ratio_db(double energy, double reference) {
    return energy > 0.0 && reference > 0.0 ? std::optional(10.0 * math::log10(energy / reference))
                                           : std::nullopt;
}

}  // namespace

StageSupport stage_support(const Bands& bands,
                           const ImpulseResponse& response,
                           std::size_t onset,
                           bool ends_in_noise) {
    EARSHOT_ASSERT(onset < response.samples.size());
    StageSupport support{.early_db = std::vector<std::optional<double>>(bands.count()),
                         .late_db = std::vector<std::optional<double>>(bands.count())};
    const double after_onset =
        static_cast<double>(response.samples.size() - onset) / response.sample_rate;
    if (after_onset < kEarlyEnd) {
        for (const char* metric : {"st_early", "st_late"}) {
            support.notes.push_back(
                {.metric = metric,
                 .band_hz = {},
                 .text = "the response ends within 100 ms of the direct sound"});
        }
        return support;
    }
    const FilterCache cache;
    const BandEnergy energy(bands, response.samples, response.sample_rate, cache);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const CheckedCurve checked = curve_of(bands, band, energy, response, onset, ends_in_noise);
        if (!checked.curve) {
            support.notes.push_back(note_at("st_early", bands, band, checked.why_not));
            support.notes.push_back(note_at("st_late", bands, band, checked.why_not));
            continue;
        }
        const DecayCurve& curve = *checked.curve;
        const double direct = curve.energy() - curve.energy_from(kDirectEnd);
        support.early_db[band] =
            ratio_db(curve.energy_from(kEarlyBegin) - curve.energy_from(kEarlyEnd), direct);
        support.late_db[band] =
            ratio_db(curve.energy_from(kEarlyEnd) - curve.energy_from(kLateEnd), direct);
    }
    const auto level = [](double value_db) { return value_db; };
    support.early_mean_db = mean_between(bands, support.early_db, 195.0, 2600.0, level);
    support.late_mean_db = mean_between(bands, support.late_db, 195.0, 2600.0, level);
    return support;
}

LateLateralLevel late_lateral_level(
    const Bands& bands,
    const ImpulseResponse& figure_of_eight,
    std::size_t onset,
    bool ends_in_noise,
    const std::optional<std::vector<std::optional<double>>>& correction_db) {
    EARSHOT_ASSERT(onset < figure_of_eight.samples.size());
    EARSHOT_ASSERT(!correction_db || correction_db->size() == bands.count());
    LateLateralLevel level{.level_db = std::vector<std::optional<double>>(bands.count())};
    if (!correction_db) {
        level.notes.push_back(
            {.metric = "lj", .band_hz = {}, .text = "the response is not calibrated"});
        return level;
    }
    const FilterCache cache;
    const BandEnergy energy(bands, figure_of_eight.samples, figure_of_eight.sample_rate, cache);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const CheckedCurve checked =
            curve_of(bands, band, energy, figure_of_eight, onset, ends_in_noise);
        if (checked.curve && (*correction_db)[band]) {
            level.level_db[band] = ratio_db(checked.curve->energy_from(kMusicLimit),
                                            kReferenceEnergy * checked.reference);
        }
        if (level.level_db[band]) {
            *level.level_db[band] += *(*correction_db)[band];
        } else {
            level.notes.push_back(note_at(
                "lj", bands, band, checked.curve ? "no energy after 80 ms" : checked.why_not));
        }
    }
    // ISO 3382-1:2009, A.2.4: an energetic mean.
    const auto mean = mean_between(bands, level.level_db, 95.0, 1300.0, [](double value_db) {
        return math::pow10(value_db / 10.0);
    });
    level.mean_db = mean ? std::optional(10.0 * math::log10(*mean)) : std::nullopt;
    return level;
}

}  // namespace earshot::audio
