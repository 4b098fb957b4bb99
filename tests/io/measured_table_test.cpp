// SPDX-License-Identifier: MIT
#include "earshot/io/measured_table.h"

#include "earshot/base/error.h"
#include "earshot/io/measured_responses.h"
#include "earshot/io/wav.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace earshot::io {
namespace {

class MeasuredTable : public testing::Test {
protected:
    MeasuredTable() {
        scene_.sources = {{.name = "talker"}, {.name = "piano"}};
        scene_.listeners = {{.name = "front"}, {.name = "back"}};
    }

    MeasuredMetrics read(const std::string& text, std::vector<std::size_t> kinds = {}) const {
        const auto file = folder_.path() / "table.csv";
        std::ofstream(file, std::ios::binary) << text;
        return read_measured_table(file, scene_, audio::Bands::octaves(), kinds);
    }

    /// The line of the error that reading the text ends in.
    std::string error_of(const std::string& text) const {
        try {
            read(text);
        } catch (const Error& error) {
            return error.line();
        }
        return "";
    }

    propagation::Scene scene_;
    const test::TemporaryFolder folder_;
};

TEST_F(MeasuredTable, HoldsAValuePerRow) {
    const MeasuredMetrics found = read(
        "source,listener,metric,band,value,error\r\n"
        "talker,back,t30,500,1.2,0.05\r\n\r\n"
        "piano, front ,c80,63,-3.5\n"
        "piano,front,edt,63,,\n"
        "talker,back,g,16000,12,\n");
    const std::vector<propagation::MeasuredMetric> expected = {
        {.source = 0, .listener = 1, .kind = 2, .band = 4, .value = 1.2, .error = 0.05},
        {.source = 1, .listener = 0, .kind = 4, .band = 1, .value = -3.5},
        {.source = 0, .listener = 1, .kind = 7, .band = 9, .value = 12.0}};
    EXPECT_EQ(found.values, expected);
    EXPECT_TRUE(found.warnings.empty());
}

TEST_F(MeasuredTable, LeavesOutOtherMetricsAndPairsThatTheSceneLacks) {
    const MeasuredMetrics found = read(
        "talker,back,t30,500,1.2\n"
        "talker,back,c80,500,2\n"
        "talker,gallery,t30,500,1.2\n"
        "talker,gallery,t30,1000,1.2\n",
        {2});
    EXPECT_EQ(found.values.size(), 1U);
    ASSERT_EQ(found.warnings.size(), 1U);
    EXPECT_NE(found.warnings[0].what.find("talker, gallery; 2 values left out"), std::string::npos);
}

TEST_F(MeasuredTable, IsRefusedWithTheLine) {
    const std::string good = "talker,back,t30,500,1.2\n";
    const auto refuses = [&](const std::string& row, const std::string& part) {
        const std::string line = error_of(good + row);
        EXPECT_NE(line.find("line 2"), std::string::npos) << row << ": " << line;
        EXPECT_NE(line.find(part), std::string::npos) << row << ": " << line;
    };
    refuses("talker,back,t30,500\n", "4 columns");
    refuses("talker,back,t30,500,1,2,3\n", "7 columns");
    refuses("talker,back,rt60,500,1.2\n", "metric 'rt60'");
    refuses("talker,back,,500,1.2\n", "metric ''");
    refuses("talker,back,t30,440,1.2\n", "band '440'");
    refuses("talker,back,t30,nan,1.2\n", "band 'nan'");
    refuses("talker,back,t30,-500,1.2\n", "band '-500'");
    refuses("talker,back,t30,1000,0\n", "value '0'");
    refuses("talker,back,t30,1000,-1\n", "value '-1'");
    refuses("talker,back,c80,1000,nan\n", "value 'nan'");
    refuses("talker,back,c80,1000,inf\n", "value 'inf'");
    refuses("talker,back,c80,1000,1e300\n", "value '1e300'");
    refuses("talker,back,c80,1000,1;5\n", "value '1;5'");
    refuses("talker,back,c80,1000,1,0\n", "standard error '0'");
    refuses("talker,back,c80,1000,1,-1\n", "standard error '-1'");
    refuses("talker,back,c80,1000,1,nan\n", "standard error 'nan'");
    refuses("talker,back,t30,500,1.3\n", "second time");
    refuses("source,listener,metric,band,value\n", "metric 'metric'");
}

TEST_F(MeasuredTable, WithoutValuesIsRefused) {
    for (const char* text : {"",
                             "\n\n",
                             "source,listener,metric,band,value\n",
                             "talker,gallery,t30,500,1\n",
                             "talker,back,t30,500,\n"}) {
        EXPECT_NE(error_of(text).find("holds no measured value"), std::string::npos) << text;
    }
    EXPECT_THROW(
        read_measured_table(folder_.path() / "absent.csv", scene_, audio::Bands::octaves()), Error);
    EXPECT_NE(error_of(std::string("\xff\xfet\0a\0", 6)).find("UTF-16"), std::string::npos);
}

TEST(MetricKeys, AreReadBetweenCommas) {
    EXPECT_EQ(parse_metric_keys("edt, t30,g"), (std::vector<std::size_t>{0, 2, 7}));
    for (const char* text : {"", "t30,", "t60", "sti", "t30,t30", "T30"}) {
        EXPECT_THROW(parse_metric_keys(text), Error) << text;
    }
}

TEST_F(MeasuredTable, OrAFolderOfRecordingsNamedAsIrNamesThem) {
    // A decay of 60 dB in 0.8 s.
    Sound sound{.sample_rate = 16000, .channels = 1, .samples = {}};
    std::uint32_t state = 1;
    for (int i = 0; i < 24000; ++i) {
        state = state * 1664525U + 1013904223U;
        const double noise = static_cast<double>(state) / 2147483648.0 - 1.0;
        sound.samples.push_back(0.5 * noise * std::pow(10.0, -3.0 * i / (0.8 * 16000)));
    }
    for (const char* name : {"talker__back.wav", "talker__cellar.wav", "notes.txt"}) {
        std::ofstream(folder_.path() / name, std::ios::binary) << encode_wav(sound);
    }
    const MeasuredResponseOptions options = {.kinds = {2, 7}, .noise_free = true};
    const MeasuredMetrics found = read_measured(folder_.path(), scene_, options, false);
    std::size_t count = 0;
    for (const propagation::MeasuredMetric& value : found.values) {
        EXPECT_EQ(value.kind, 2U);  // G has no calibration
        EXPECT_EQ(value.listener, 1U);
        if (value.band >= 5) {
            EXPECT_NEAR(value.value, 0.8, 0.08);
            ++count;
        }
    }
    EXPECT_GE(count, 3U);
    std::string warnings;
    for (const Warning& warning : found.warnings) {
        warnings += warning.subject + ": " + warning.what + "\n";
    }
    EXPECT_NE(warnings.find("talker__cellar.wav: is of no pair"), std::string::npos) << warnings;
    EXPECT_NE(warnings.find("values of g are not supported"), std::string::npos) << warnings;
    EXPECT_EQ(warnings.find("notes.txt"), std::string::npos) << warnings;

    std::ofstream(folder_.path() / "talker__back.aiff", std::ios::binary) << encode_wav(sound);
    EXPECT_THROW(read_measured(folder_.path(), scene_, options, false), Error);
    scene_.listeners = {{.name = "attic"}};
    EXPECT_THROW(read_measured(folder_.path(), scene_, options, false), Error);
}

}  // namespace
}  // namespace earshot::io
