// SPDX-License-Identifier: MIT
#include "earshot/audio/room_metrics.h"

#include <gtest/gtest.h>

#include <numeric>
#include <utility>

namespace earshot::audio {
namespace {

TEST(MidFrequencyMeans, AreOverTheOctaves500HzAnd1kHz) {
    std::vector<BandMetrics> values(10);
    values[4].reverberation_time_t30 = 1.0;
    values[5].reverberation_time_t30 = 1.5;
    values[6].reverberation_time_t30 = 9.0;
    values[5].clarity_c80_db = 3.0;
    const BandMetrics means = mid_frequency_means(Bands::octaves(), values);
    EXPECT_EQ(means.reverberation_time_t30, 1.25);
    EXPECT_FALSE(means.clarity_c80_db);  // 500 Hz lacks it
    EXPECT_FALSE(means.strength_db);
}

TEST(MidFrequencyMeans, AreOverSixThirds) {
    const Bands& bands = Bands::third_octaves();
    std::vector<double> numbers(bands.count());
    std::iota(numbers.begin(), numbers.end(), 0.0);
    // 400 Hz is the third number 13, 1250 Hz number 18.
    EXPECT_EQ(bands.nominal_hz()[13], 400.0);
    EXPECT_EQ(mid_frequency_mean(bands, numbers), 15.5);
    std::vector<BandMetrics> values(bands.count());
    for (std::size_t band = 0; band < bands.count(); ++band) {
        values[band].strength_db = numbers[band];
    }
    EXPECT_EQ(mid_frequency_means(bands, values).strength_db, 15.5);
}

TEST(BandMetricKinds, HaveTheLimensOfTheStandard) {
    // ISO 3382-1:2009, table A.1, by key.
    const std::vector<std::pair<std::string, double>> expected = {{"edt", 0.05},
                                                                  {"t20", 0.05},
                                                                  {"t30", 0.05},
                                                                  {"c50", 1.0},
                                                                  {"c80", 1.0},
                                                                  {"d50", 0.05},
                                                                  {"ts", 0.01},
                                                                  {"g", 1.0}};
    ASSERT_EQ(expected.size(), kBandMetricKinds.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(kBandMetricKinds[i].key, expected[i].first);
        EXPECT_EQ(kBandMetricKinds[i].just_noticeable_difference, expected[i].second);
        EXPECT_EQ(kBandMetricKinds[i].relative, i < 3);
    }
}

}  // namespace
}  // namespace earshot::audio
