// SPDX-License-Identifier: MIT
// Late noise and metrics against the textbook's, and their bits with every instruction set.
#include "plain_metrics.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/late_noise.h"
#include "earshot/audio/response_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/base/digest.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

namespace earshot::audio {
namespace {

constexpr double kSampleRate = 48000.0;
/// Rounding, and what of a filter's ringing folds back in transforms of different sizes.
constexpr double kRounding = 1e-9;

/// Half a second's histogram with a decay of its own in each band.
EnergyHistogram some_histogram() {
    EnergyHistogram histogram{.reflection_growth = 2e6, .full_decay = true};
    histogram.energy.resize(700);
    for (std::size_t bin = 12; bin < histogram.energy.size(); ++bin) {
        const double time = 1e-3 * static_cast<double>(bin);
        for (std::size_t band = 0; band < kMaxBands; ++band) {
            const double decay = 0.6 - 0.02 * static_cast<double>(band);
            histogram.energy[bin][band] =
                1e-3 * std::pow(10.0, -6.0 * time / decay) * (0.5 + random(2, band, bin));
        }
    }
    return histogram;
}

/// Direct sound and late noise.
ImpulseResponse some_response() {
    ImpulseResponse response{kSampleRate,
                             late_noise(Bands::octaves(), some_histogram(), kSampleRate, 5)};
    response.samples[480] += 0.1;
    return response;
}

void expect_metrics(const BandMetrics& found, const plain::Metrics& expected, double reference_db) {
    EXPECT_NEAR(found.early_decay_time.value(), expected.edt, kRounding * expected.edt);
    EXPECT_NEAR(found.reverberation_time_t20.value(), expected.t20, kRounding * expected.t20);
    EXPECT_NEAR(found.reverberation_time_t30.value(), expected.t30, kRounding * expected.t30);
    EXPECT_NEAR(found.clarity_c50_db.value(), expected.c50_db, 10.0 * kRounding);
    EXPECT_NEAR(found.clarity_c80_db.value(), expected.c80_db, 10.0 * kRounding);
    EXPECT_NEAR(found.definition_d50.value(), expected.d50, kRounding);
    EXPECT_NEAR(found.centre_time.value(), expected.centre_time, kRounding);
    EXPECT_NEAR(
        found.strength_db.value(), expected.energy_db - reference_db + 20.0, 10.0 * kRounding);
}

TEST(LateNoise, IsThatOfTheTextbook) {
    EnergyHistogram histogram = some_histogram();
    histogram.energy.resize(100);
    for (const double growth : {0.0, 2e6}) {
        histogram.reflection_growth = growth;
        const auto found = late_noise(Bands::octaves(), histogram, kSampleRate, 9);
        const auto expected = plain::late_noise(histogram, kSampleRate, 9);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t n = 0; n < found.size(); ++n) {
            ASSERT_NEAR(found[n], expected[n], 1e-15) << n;
        }
    }
}

TEST(LateNoise, ChangesItsEnergyWhereAnIntervalBegins) {
    // 44.1 samples per interval: their limits are not whole numbers.
    EnergyHistogram histogram{.energy = std::vector<Spectrum>(60)};
    for (std::size_t bin = 0; bin < histogram.energy.size(); bin += 2) {
        histogram.energy[bin].fill(1.0);
    }
    const auto samples = late_noise(Bands::octaves(), histogram, 44100.0, 1);
    for (std::size_t n = 0; n < samples.size(); ++n) {
        const auto bin = static_cast<std::size_t>(static_cast<double>(n) / 44.1);
        EXPECT_EQ(samples[n] == 0.0, bin % 2 != 0) << n;
    }
}

TEST(ResponseMetrics, AreThoseOfTheTextbook) {
    const ImpulseResponse response = some_response();
    const RoomMetrics metrics =
        response_metrics(Bands::octaves(), response, {.full_decay = true, .onset = 480});
    const std::vector<double> impulse{1.0};
    std::array<std::vector<double>, 7> speech;
    for (const std::size_t band : {2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
        SCOPED_TRACE(band);
        speech[band - 2] = plain::squared(response.samples, kSampleRate, band);
        if (band < 4) {
            continue;  // the filters ring for longer than the decay
        }
        double reference = 0.0;
        for (const double energy : plain::squared(impulse, kSampleRate, band)) {
            reference += energy;
        }
        expect_metrics(
            metrics.bands[band],
            plain::metrics_of(speech[band - 2], plain::lead(kSampleRate) + 480, kSampleRate),
            10.0 * std::log10(reference));
    }
    // The library sums energies over quarters of a millisecond first.
    EXPECT_NEAR(
        metrics.speech_transmission_index.value(), plain::speech_index(speech, kSampleRate), 1e-4);
}

TEST(EnergyMetrics, AreThoseOfTheTextbook) {
    const EnergyHistogram late = some_histogram();
    const RoomMetrics metrics = energy_metrics(Bands::octaves(), {}, late);
    std::array<std::vector<double>, 7> speech;
    for (std::size_t band = 0; band < Bands::octaves().count(); ++band) {
        SCOPED_TRACE(band);
        std::vector<double> energy;
        double largest = 0.0;
        for (const Spectrum& bin : late.energy) {
            energy.insert(energy.end(), 10, 0.1 * bin[band]);
            largest = std::max(largest, energy.back());
        }
        std::size_t onset = 0;
        while (energy[onset] < 0.01 * largest) {
            ++onset;
        }
        expect_metrics(metrics.bands[band], plain::metrics_of(energy, onset, 1e4), 0.0);
        if (band >= 2 && band < 9) {
            speech[band - 2] = energy;
        }
    }
    EXPECT_NEAR(metrics.speech_transmission_index.value(), plain::speech_index(speech, 1e4), 1e-4);
}

TEST(BinauralMetrics, AreThoseOfTheTextbook) {
    ImpulseResponse left = some_response();
    left.samples.resize(9600);
    ImpulseResponse right = left;
    for (std::size_t n = 0; n < right.samples.size(); ++n) {
        right.samples[n] =
            (n < 11 ? 0.0 : left.samples[n - 11]) + random_between(8, 0, n, -1e-3, 1e-3);
    }
    const BinauralMetrics metrics = binaural_metrics(Bands::octaves(), left, right);
    const std::size_t begin = plain::lead(kSampleRate) + 480;
    const std::size_t early_end = begin + 3840;
    for (const std::size_t band : {0U, 4U, 9U}) {
        SCOPED_TRACE(band);
        const auto l = plain::in_octave(left.samples, kSampleRate, band);
        const auto r = plain::in_octave(right.samples, kSampleRate, band);
        const auto between = [&](std::size_t from, std::size_t to) {
            return plain::interaural_correlation(l, r, from, to, kSampleRate);
        };
        EXPECT_NEAR(metrics.iacc_early[band].value(), between(begin, early_end), 10.0 * kRounding);
        EXPECT_NEAR(
            metrics.iacc_late[band].value(), between(early_end, l.size()), 10.0 * kRounding);
        EXPECT_NEAR(metrics.iacc[band].value(), between(begin, l.size()), 10.0 * kRounding);
    }
}

std::uint64_t digest_of_late_noise_and_metrics() {
    Digest digest;
    const auto add = [&](const RoomMetrics& metrics) {
        for (const BandMetrics& band : metrics.bands) {
            for (const BandMetricKind& kind : kBandMetricKinds) {
                digest.add((band.*kind.value).value_or(-1.0));
            }
        }
        digest.add(metrics.speech_transmission_index.value_or(-1.0));
    };
    const EnergyHistogram late = some_histogram();
    for (const double sample : late_noise(Bands::octaves(), late, kSampleRate, 3)) {
        digest.add(sample);
    }
    HistogramReplicates replicates;
    for (std::size_t bin = 0; bin <= late.energy.size(); bin += 7) {
        replicates.first_bin.push_back(bin);
    }
    for (std::size_t r = 0; r < 5; ++r) {
        auto& energy = replicates.energy.emplace_back(replicates.first_bin.size() - 1);
        for (std::size_t k = 0; k < energy.size(); ++k) {
            energy[k] = late.energy[7 * k + r];
        }
    }
    const RoomMetrics expected =
        energy_metrics(Bands::octaves(), {}, late, {.replicates = &replicates});
    add(expected);
    add({expected.standard_error, {}, {}, {}});
    add(response_metrics(Bands::octaves(), some_response()));
    add(response_metrics(Bands::third_octaves(), some_response()));
    const ImpulseResponse right{kSampleRate, late_noise(Bands::octaves(), late, kSampleRate, 6)};
    for (const auto& value : binaural_metrics(Bands::octaves(), some_response(), right).iacc) {
        digest.add(value.value_or(-1.0));
    }
    return digest.value();
}

TEST(Metrics, HaveTheSameBitsWithEveryInstructionSet) {
    const std::uint64_t expected = digest_of_late_noise_and_metrics();
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(digest_of_late_noise_and_metrics(), expected) << target;
    }
    override_simd_target("auto");
}

}  // namespace
}  // namespace earshot::audio
