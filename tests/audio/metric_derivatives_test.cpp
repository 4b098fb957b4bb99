// SPDX-License-Identifier: MIT
// Derivatives of metrics against differences of the metrics themselves, as energy_metrics() finds
// them for energies that are changed a little.
#include "earshot/audio/metric_derivatives.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/speech_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace earshot::audio {
namespace {

constexpr double kStep = 1e-3;

/// Direct sound, a few reflections, and a late decay that bends: fast, then slow.
struct Course {
    std::vector<Arrival> arrivals{};
    EnergyHistogram late{.full_decay = true};

    explicit Course(const Bands& bands) {
        for (const double delay : {0.0123, 0.0201, 0.0317, 0.0555, 0.0801, 0.0977}) {
            Arrival& arrival = arrivals.emplace_back();
            arrival.delay = delay;
            for (std::size_t band = 0; band < bands.count(); ++band) {
                arrival.pressure[band] = (delay < 0.02 ? 0.002 : 0.0005) / delay *
                                         (1.0 - 0.02 * static_cast<double>(band));
            }
        }
        late.energy.resize(1500);
        for (std::size_t n = 15; n < late.energy.size(); ++n) {
            const double time = 1e-3 * (static_cast<double>(n) + 0.5);
            for (std::size_t band = 0; band < bands.count(); ++band) {
                const double fast = 0.5 + 0.02 * static_cast<double>(band);
                late.energy[n][band] = 2e-4 * (std::pow(10.0, -6.0 * time / fast) +
                                               0.02 * std::pow(10.0, -6.0 * time / 1.3));
            }
        }
    }
};

/// What a wall that sound meets about every 20 ms does to the energies of a band.
struct Rates {
    std::vector<double> arrivals{}, bins{};

    Rates(const Course& course, std::size_t band) {
        for (const Arrival& arrival : course.arrivals) {
            const double reflections = std::floor(arrival.delay / 0.02);
            arrivals.push_back(-reflections * arrival.pressure[band] * arrival.pressure[band]);
        }
        for (std::size_t n = 0; n < course.late.energy.size(); ++n) {
            bins.push_back(-0.05 * static_cast<double>(n) * course.late.energy[n][band]);
        }
    }
    EnergyRates view() const { return {.arrivals = arrivals, .bins = bins}; }
};

/// Energies go with the exponential of a parameter, as those of many reflections do.
Course moved(const Course& course, const Rates& rates, std::size_t band, double step) {
    Course result = course;
    for (std::size_t i = 0; i < result.arrivals.size(); ++i) {
        double& pressure = result.arrivals[i].pressure[band];
        pressure *= std::exp(0.5 * step * rates.arrivals[i] / (pressure * pressure));
    }
    for (std::size_t n = 0; n < result.late.energy.size(); ++n) {
        double& energy = result.late.energy[n][band];
        energy *= energy > 0.0 ? std::exp(step * rates.bins[n] / energy) : 1.0;
    }
    return result;
}

RoomMetrics metrics_of(const Bands& bands,
                       const Course& course,
                       const std::optional<SpeechConditions>& speech = {}) {
    return energy_metrics(bands, course.arrivals, course.late, {.speech = speech});
}

TEST(MetricDerivatives, AreTheDifferencesOfTheMetrics) {
    for (const Bands& bands : {Bands::octaves(), Bands::third_octaves()}) {
        const Course course(bands);
        const MetricDerivatives derivatives(bands, course.arrivals, course.late);
        for (const std::size_t band : {std::size_t{2}, std::size_t{5}, bands.count() - 1}) {
            const Rates rates(course, band);
            const BandMetrics found = derivatives.of_band(band, rates.view());
            for (const BandMetricKind& kind : kBandMetricKinds) {
                // Reverberation times jump where an end of their range passes a step of the decay:
                // their differences are those of a change that moves the lower end by about half
                // a decibel, which is soonest at the deepest.
                const double step = (kind.key == "edt"   ? 20.0
                                     : kind.key == "t20" ? 8.0
                                     : kind.key == "t30" ? 5.0
                                                         : 1.0) *
                                    kStep;
                const bool is_time = step > kStep;
                const auto value_at = [&](double change) {
                    return *(metrics_of(bands, moved(course, rates, band, change)).bands[band].*
                             kind.value);
                };
                const double difference = (value_at(step) - value_at(-step)) / (2.0 * step);
                EXPECT_NEAR(*(found.*kind.value),
                            difference,
                            (is_time ? 0.04 : 1e-4) * std::abs(difference) + 1e-9)
                    << kind.key << " of band " << band;
            }
        }
    }
}

TEST(MetricDerivatives, FollowTheSpeechTransmissionIndex) {
    constexpr double kSmallStep = 1e-5;  // the index has kinks, at limits of modulation and masking
    std::vector<std::optional<SpeechConditions>> conditions = {
        std::nullopt,
        SpeechConditions{.speech_level_db = 60.0, .noise_db = noise_criterion_db(30.0)},
        SpeechConditions{.speech_level_db = 95.0},
        SpeechConditions{
            .speech_level_db = 65.0, .at_listener = true, .noise_db = noise_criterion_db(40.0)}};
    for (const Bands& bands : {Bands::octaves(), Bands::third_octaves()}) {
        const Course course(bands);
        for (const auto& speech : conditions) {
            const MetricDerivatives derivatives(bands, course.arrivals, course.late, speech);
            for (std::size_t band = 0; band < bands.count(); ++band) {
                const Rates rates(course, band);
                const double more =
                    *metrics_of(bands, moved(course, rates, band, kSmallStep), speech)
                         .speech_transmission_index;
                const double less =
                    *metrics_of(bands, moved(course, rates, band, -kSmallStep), speech)
                         .speech_transmission_index;
                const double difference = (more - less) / (2.0 * kSmallStep);
                EXPECT_NEAR(*derivatives.of_speech(band, rates.view()),
                            difference,
                            1e-3 * std::abs(difference) + 1e-9)
                    << "band " << band;
            }
        }
    }
}

TEST(MetricDerivatives, AreLinearInTheRates) {
    const Bands& bands = Bands::octaves();
    const Course course(bands);
    const MetricDerivatives derivatives(bands, course.arrivals, course.late);
    Rates rates(course, 5);
    const double once = *derivatives.of_band(5, rates.view()).reverberation_time_t30;
    for (std::vector<double>* numbers : {&rates.arrivals, &rates.bins}) {
        for (double& number : *numbers) {
            number *= 3.0;
        }
    }
    EXPECT_NEAR(*derivatives.of_band(5, rates.view()).reverberation_time_t30,
                3.0 * once,
                1e-12 * std::abs(once));
    // All of the sound louder by one factor: only its level changes.
    for (std::size_t i = 0; i < rates.arrivals.size(); ++i) {
        rates.arrivals[i] = course.arrivals[i].pressure[5] * course.arrivals[i].pressure[5];
    }
    for (std::size_t n = 0; n < rates.bins.size(); ++n) {
        rates.bins[n] = course.late.energy[n][5];
    }
    const BandMetrics louder = derivatives.of_band(5, rates.view());
    EXPECT_NEAR(*louder.strength_db, 10.0 / std::log(10.0), 1e-9);
    EXPECT_NEAR(*louder.reverberation_time_t30, 0.0, 1e-9);
    EXPECT_NEAR(*louder.early_decay_time, 0.0, 1e-9);
    EXPECT_NEAR(*louder.clarity_c80_db, 0.0, 1e-9);
    EXPECT_NEAR(*louder.centre_time, 0.0, 1e-9);
    EXPECT_NEAR(*derivatives.of_speech(5, rates.view()), 0.0, 1e-9);
}

TEST(MetricDerivatives, OfAMetricWithoutAValueAreEmpty) {
    const Bands& bands = Bands::octaves();
    const std::vector<Arrival> direct = {{.delay = 0.01, .pressure = {1.0}}};
    const MetricDerivatives derivatives(bands, direct, {});
    const std::vector<double> rate = {1.0};
    EXPECT_FALSE(derivatives.of_band(0, {.arrivals = rate}).reverberation_time_t30);
    EXPECT_FALSE(derivatives.of_band(1, {.arrivals = rate}).strength_db);
    EXPECT_FALSE(derivatives.of_speech(3, {.arrivals = rate}));
    const MetricDerivatives silence(bands, {}, {});
    EXPECT_FALSE(silence.of_band(4, {}).strength_db);
}

}  // namespace
}  // namespace earshot::audio
