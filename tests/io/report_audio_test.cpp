// SPDX-License-Identifier: MIT
#include "earshot/io/report_audio.h"

#include <gtest/gtest.h>

#include "base64_text.h"
#include <cstring>
#include <vector>

namespace earshot::io {
namespace {

using audio::Signal;

/// The samples of a data URI of 16-bit WAV.
std::vector<std::int16_t> samples_of(const std::string& uri, int channels) {
    const std::string head = "data:audio/wav;base64,";
    EXPECT_EQ(uri.substr(0, head.size()), head);
    const std::string file = decoded(uri.substr(head.size()));
    EXPECT_EQ(file.substr(0, 4), "RIFF");
    EXPECT_EQ(file.substr(8, 8), "WAVEfmt ");
    EXPECT_EQ(file[22], channels);
    EXPECT_EQ(static_cast<unsigned char>(file[24]) + 256 * static_cast<unsigned char>(file[25]),
              16000);
    std::vector<std::int16_t> samples((file.size() - 44) / 2);
    std::memcpy(samples.data(), file.data() + 44, 2 * samples.size());
    return samples;
}

TEST(ReportAudio, OfAnIdealResponseSoundsAsItWasRecorded) {
    const Signal dry{.sample_rate = 16000, .channels = {{0.0, 0.5, -0.25, 0.1, 0.0}}};
    const Signal response{.sample_rate = 16000, .channels = {{3.0}}};
    const ReportAudio audio = make_report_audio(dry, response);
    const std::vector<std::int16_t> samples = samples_of(audio.dry, 1);
    EXPECT_EQ(samples, samples_of(audio.wet, 1));
    EXPECT_EQ(samples, (std::vector<std::int16_t>{0, 22937, -11468, 4587, 0}));
}

TEST(ReportAudio, IsShortAndHasAtMostTwoChannels) {
    const Signal dry{.sample_rate = 8000, .channels = {std::vector<double>(100000, 0.1)}};
    const Signal ears{.sample_rate = 8000, .channels = {{1.0}, {0.5}}};
    const ReportAudio audio = make_report_audio(dry, ears);
    EXPECT_EQ(samples_of(audio.dry, 1).size(), 160000U);
    EXPECT_EQ(samples_of(audio.wet, 2).size(), 320000U);
    const Signal harmonics{.sample_rate = 8000, .channels = {{1.0}, {0.5}, {0.5}, {0.5}}};
    EXPECT_EQ(samples_of(make_report_audio(dry, harmonics).wet, 1).size(), 160000U);
}

TEST(ReportAudio, OfSilenceIsSilent) {
    const Signal silence{.sample_rate = 16000, .channels = {{0.0, 0.0}}};
    EXPECT_EQ(samples_of(make_report_audio(silence, silence).dry, 1),
              (std::vector<std::int16_t>{0, 0}));
}

}  // namespace
}  // namespace earshot::io
