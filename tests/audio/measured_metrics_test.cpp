// SPDX-License-Identifier: MIT
#include "earshot/audio/measured_metrics.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

namespace earshot::audio {
namespace {

constexpr double kRate = 24000.0;
constexpr double kLogMillion = 13.815510557964274;

ImpulseResponse silence(double time) {
    return {kRate, std::vector<double>(std::size_t(time * kRate))};
}

// A decay that begins at once: in each octave a tone at its centre, so that no chance fluctuation
// stands between the samples and the closed form.
ImpulseResponse tonal_decay(double time) {
    ImpulseResponse response = silence(1.3 * time + 0.5);
    const Bands& bands = Bands::octaves();
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        const double t = double(n) / kRate;
        for (std::size_t band = 0; band < 9; ++band) {
            response.samples[n] += std::sin(2.0 * std::numbers::pi * bands.exact_hz()[band] * t +
                                            2.0 * double(band * band)) *
                                   std::exp(-0.5 * kLogMillion * t / time);
        }
    }
    return response;
}

ImpulseResponse noise_decay(double time, std::uint64_t seed) {
    ImpulseResponse response = silence(1.3 * time + 0.5);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        response.samples[n] = random_between(seed, 0, n, -1.0, 1.0) *
                              std::exp(-0.5 * kLogMillion * double(n) / kRate / time);
    }
    return response;
}

double peak_of(const ImpulseResponse& response) {
    double peak = 0.0;
    for (const double sample : response.samples) {
        peak = std::max(peak, std::abs(sample));
    }
    return peak;
}

double amplitude(double level_db) {
    return std::pow(10.0, level_db / 20.0);
}

// White noise of this level re the peak.
void add_noise(ImpulseResponse& response, double level_db) {
    const double scale = peak_of(response) * amplitude(level_db) * std::sqrt(3.0);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        response.samples[n] += scale * random_between(77, 5, n, -1.0, 1.0);
    }
}

void add_hum(ImpulseResponse& response, double mains_hz, double level_db) {
    const double scale = peak_of(response) * amplitude(level_db);
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        for (int k = 1; k <= 5; ++k) {
            response.samples[n] +=
                scale / k *
                std::sin(2.0 * std::numbers::pi * mains_hz * k * double(n) / kRate + k * k);
        }
    }
}

void insert_before(ImpulseResponse& response, double time) {
    response.samples.insert(response.samples.begin(), std::size_t(time * kRate), 0.0);
}

void append(ImpulseResponse& response, double time) {
    response.samples.resize(response.samples.size() + std::size_t(time * kRate), 0.0);
}

void clip(ImpulseResponse& response, double headroom_db) {
    const double limit = peak_of(response) * amplitude(headroom_db);
    for (double& sample : response.samples) {
        sample = std::clamp(sample, -limit, limit);
    }
}

// The response again, ahead of itself, a little other each time.
void add_pre_arrivals(ImpulseResponse& response) {
    const ImpulseResponse clean = response;
    const auto ahead = [](double time) { return std::size_t(time * kRate); };
    insert_before(response, 0.7);
    for (std::size_t n = 0; n < clean.samples.size(); ++n) {
        response.samples[n] += amplitude(-30.0) * clean.samples[n];
        response.samples[n + ahead(0.3)] += amplitude(-15.0) * clean.samples[n];
    }
}

// What a recording does to a decay, why a value may then be missing (besides the band's filter),
// and how many of the 56 values of a decay are given at least, on average.
struct Degradation {
    const char* name;
    std::vector<std::string> reasons;
    int min_given;
    std::function<void(ImpulseResponse&, double time)> apply;
};

const std::vector<Degradation>& degradations() {
    static const std::vector<Degradation> all = {
        {"zeros behind",
         {"noise"},
         50,
         [](ImpulseResponse& r, double) {
             add_noise(r, -55.0);
             append(r, 0.7);
         }},
        {"zeros before",
         {"noise"},
         52,
         [](ImpulseResponse& r, double) {
             add_noise(r, -70.0);
             insert_before(r, 1.0);
         }},
        {"zeros on both sides and noise before",
         {"noise"},
         36,
         [](ImpulseResponse& r, double) {
             insert_before(r, 0.2);
             add_noise(r, -40.0);
             insert_before(r, 0.5);
             append(r, 0.5);
         }},
        {"clipped by 1 dB", {"clipped"}, 50, [](ImpulseResponse& r, double) { clip(r, -1.0); }},
        {"clipped by 12 dB", {"clipped"}, 0, [](ImpulseResponse& r, double) { clip(r, -12.0); }},
        {"hum of 50 Hz",
         {"hum", "noise"},
         24,
         [](ImpulseResponse& r, double) { add_hum(r, 50.0, -30.0); }},
        {"hum of 60 Hz",
         {"hum", "noise"},
         38,
         [](ImpulseResponse& r, double) {
             add_noise(r, -70.0);
             add_hum(r, 60.0, -50.0);
         }},
        {"noise, -60 dB", {"noise"}, 52, [](ImpulseResponse& r, double) { add_noise(r, -60.0); }},
        {"noise, -45 dB", {"noise"}, 40, [](ImpulseResponse& r, double) { add_noise(r, -45.0); }},
        {"noise, -30 dB", {"noise"}, 15, [](ImpulseResponse& r, double) { add_noise(r, -30.0); }},
        {"offset",
         {"noise"},
         52,
         [](ImpulseResponse& r, double) {
             add_noise(r, -60.0);
             for (double& sample : r.samples) {
                 sample += 0.3;
             }
         }},
        {"harmonics ahead",
         {"noise"},
         46,
         [](ImpulseResponse& r, double) {
             add_pre_arrivals(r);
             add_noise(r, -50.0);
         }},
        {"cut at -25 dB, zeros behind",
         {"ends before", "bends", "decay range", "noise"},
         16,
         [](ImpulseResponse& r, double time) {
             r.samples.resize(std::size_t(25.0 / 60.0 * time * kRate));
             append(r, 0.3);
         }},
        {"cut at -12 dB",
         {"ends before", "bends", "decay range", "noise", "ends within"},
         0,
         [](ImpulseResponse& r, double time) {
             r.samples.resize(std::size_t(0.2 * time * kRate));
         }},
    };
    return all;
}

BandMetrics ideal_metrics(double time) {
    const auto clarity_db = [&](double limit) {
        return 10.0 * std::log10(std::exp(kLogMillion * limit / time) - 1.0);
    };
    BandMetrics band;
    band.early_decay_time = band.reverberation_time_t20 = band.reverberation_time_t30 = time;
    band.clarity_c50_db = clarity_db(0.05);
    band.clarity_c80_db = clarity_db(0.08);
    band.definition_d50 = 1.0 - std::exp(-kLogMillion * 0.05 / time);
    band.centre_time = time / kLogMillion;
    return band;
}

// IEC 60268-16 of exponential decays of one time: all octaves have one index, so that the index is
// that times what the weights add up to, 1.381 - 0.381.
double ideal_speech_transmission_index(double time) {
    double sum = 0.0;
    for (const double modulation_hz :
         {0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0, 12.5}) {
        const double m =
            1.0 / std::hypot(1.0, 2.0 * std::numbers::pi * modulation_hz * time / kLogMillion);
        sum += (std::clamp(10.0 * std::log10(m / (1.0 - m)), -15.0, 15.0) + 15.0) / 30.0;
    }
    return sum / 14.0;
}

constexpr double kTimes[] = {0.4, 0.7, 1.0, 1.5, 2.2, 3.0};
constexpr std::size_t kFirstBand = 0;  // 31.5 Hz
constexpr std::size_t kLastBand = 8;   // 8 kHz

bool has_reason(const RoomMetrics& metrics,
                std::string_view metric,
                double band_hz,
                const Degradation& degradation) {
    return std::any_of(metrics.notes.begin(), metrics.notes.end(), [&](const MetricNote& note) {
        const bool is_on_it = (note.metric == metric || note.metric == "all") &&
                              (!note.band_hz || band_hz == 0.0 || *note.band_hz == band_hz);
        const bool is_true = note.text.find("the band's filter ") != std::string::npos ||
                             std::any_of(degradation.reasons.begin(),
                                         degradation.reasons.end(),
                                         [&](const std::string& reason) {
                                             return note.text.find(reason) != std::string::npos;
                                         });
        return is_on_it && is_true;
    });
}

std::string notes_on(const RoomMetrics& metrics, double band_hz) {
    std::string text;
    for (const MetricNote& note : metrics.notes) {
        if (!note.band_hz || *note.band_hz == band_hz) {
            text += note.metric + ": " + note.text + "; ";
        }
    }
    return text;
}

// Every value is within a just-noticeable difference of the truth, or empty with a reason. Returns
// the number of values that are given.
int expect_right_or_empty(const RoomMetrics& got,
                          const std::vector<BandMetrics>& truth,
                          double true_index,
                          const Degradation& degradation) {
    int given = 0;
    for (std::size_t b = kFirstBand; b <= kLastBand; ++b) {
        const double band_hz = Bands::octaves().nominal_hz()[b];
        for (const BandMetricKind& kind : kBandMetricKinds) {
            const auto& expected = truth[b].*kind.value;
            if (kind.key == "g" || !expected) {
                continue;
            }
            const auto& value = got.bands[b].*kind.value;
            if (value) {
                const double difference =
                    kind.just_noticeable_difference * (kind.relative ? *expected : 1.0);
                EXPECT_NEAR(*value, *expected, difference) << kind.key << " at " << band_hz;
                ++given;
            } else {
                EXPECT_TRUE(has_reason(got, kind.key, band_hz, degradation))
                    << kind.key << " at " << band_hz << " is empty without a true reason; "
                    << notes_on(got, band_hz);
            }
        }
    }
    if (got.speech_transmission_index) {
        EXPECT_NEAR(*got.speech_transmission_index, true_index, kSpeechJustNoticeableDifference);
    } else {
        EXPECT_TRUE(has_reason(got, "sti", 0.0, degradation)) << "no reason for sti";
    }
    return given;
}

TEST(MeasuredMetrics, OfDegradedDecaysAreTheClosedFormOrEmptyWithTheReason) {
    std::vector<ImpulseResponse> decays;
    for (const double time : kTimes) {
        decays.push_back(tonal_decay(time));
    }
    for (const Degradation& degradation : degradations()) {
        int given = 0;
        for (std::size_t i = 0; i < decays.size(); ++i) {
            SCOPED_TRACE(std::string(degradation.name) + ", T " + std::to_string(kTimes[i]));
            ImpulseResponse response = decays[i];
            degradation.apply(response, kTimes[i]);
            const MeasuredMetrics got = measured_metrics(Bands::octaves(), response);
            ASSERT_TRUE(got.part);
            given += expect_right_or_empty(
                got.metrics,
                std::vector<BandMetrics>(Bands::octaves().count(), ideal_metrics(kTimes[i])),
                ideal_speech_transmission_index(kTimes[i]),
                degradation);
        }
        EXPECT_GE(given, degradation.min_given * int(decays.size())) << degradation.name;
    }
}

// Decays of noise have chance values of their own: those before the recording degraded them.
TEST(MeasuredMetrics, OfDegradedDecaysOfNoiseAreTheirOwnOrEmptyWithTheReason) {
    for (const Degradation& degradation : degradations()) {
        for (std::size_t i = 0; i < std::size(kTimes); i += 2) {
            SCOPED_TRACE(std::string(degradation.name) + ", T " + std::to_string(kTimes[i]));
            ImpulseResponse response = noise_decay(kTimes[i], 3);
            const RoomMetrics truth = response_metrics(Bands::octaves(), response);
            ASSERT_TRUE(truth.speech_transmission_index);
            degradation.apply(response, kTimes[i]);
            expect_right_or_empty(measured_metrics(Bands::octaves(), response).metrics,
                                  truth.bands,
                                  *truth.speech_transmission_index,
                                  degradation);
        }
    }
}

TEST(MeasuredMetrics, TellTheLevelOfTheNoiseAndTheDynamicRange) {
    ImpulseResponse response = silence(2.0);
    // A tone that decays by 60 dB in a second from an amplitude of 1, over one of 1 kHz that stays:
    // the mean square of an amplitude a is a^2 / 2.
    const Bands& bands = Bands::octaves();
    const auto at = [](double frequency_hz, std::size_t n) {
        return std::sin(2.0 * std::numbers::pi * frequency_hz * double(n) / kRate);
    };
    for (std::size_t n = 0; n < response.samples.size(); ++n) {
        response.samples[n] =
            at(bands.exact_hz()[5], n) * std::exp(-0.5 * kLogMillion * double(n) / kRate) +
            amplitude(-50.0) * at(1100.0, n);
    }
    const RoomMetrics metrics = measured_metrics(bands, response).metrics;
    ASSERT_TRUE(metrics.noise[5].level_db && metrics.noise[5].peak_to_noise_db);
    EXPECT_NEAR(*metrics.noise[5].level_db, -53.0, 0.2);
    EXPECT_NEAR(*metrics.noise[5].peak_to_noise_db, 50.0, 1.0);  // the first 10 ms fall by 0.6 dB
}

TEST(MeasuredMetrics, StrengthNeedsACalibration) {
    const Bands& bands = Bands::octaves();
    const ImpulseResponse response = tonal_decay(1.0);
    const auto strength_db = [&](const std::optional<StrengthCorrection>& correction_db) {
        return measured_metrics(bands, response, {.strength_correction_db = correction_db})
            .metrics.bands[5]
            .strength_db;
    };
    EXPECT_FALSE(strength_db({}));
    const auto unit = strength_db(StrengthCorrection(bands.count(), 0.0));
    ASSERT_TRUE(unit);
    // A free field of amplitude 0.2 at 10 m: 6 dB above that of a source with pressure 1 at 1 m,
    // and the same from 0.4 at 5 m.
    for (const auto& [pressure, distance] : {std::pair{0.2, 10.0}, {0.4, 5.0}}) {
        ImpulseResponse free_field = silence(0.5);
        free_field.samples[3000] = pressure;
        add_noise(free_field, -90.0);
        const auto calibrated = strength_db(strength_correction_db(bands, free_field, distance));
        ASSERT_TRUE(calibrated);
        EXPECT_NEAR(*calibrated - *unit, -20.0 * std::log10(2.0), 0.05);
    }
}

TEST(BassRatio, IsOfT30OrElseOfT20) {
    const Bands& bands = Bands::octaves();
    RoomMetrics metrics;
    metrics.bands.resize(bands.count());
    for (std::size_t b = 0; b < bands.count(); ++b) {
        metrics.bands[b].reverberation_time_t30 = double(b);  // 125 Hz is band 2
        metrics.bands[b].reverberation_time_t20 = 1.0;
    }
    EXPECT_DOUBLE_EQ(*bass_ratio(bands, metrics), (2.0 + 3.0) / (4.0 + 5.0));
    metrics.bands[4].reverberation_time_t30.reset();
    EXPECT_DOUBLE_EQ(*bass_ratio(bands, metrics), 1.0);
    metrics.bands[2].reverberation_time_t20.reset();
    EXPECT_FALSE(bass_ratio(bands, metrics));
}

}  // namespace
}  // namespace earshot::audio
