// SPDX-License-Identifier: MIT
#include "earshot/io/sound_file.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace earshot::io {
namespace {

Sound two_tones(double sample_rate) {
    Sound sound{.sample_rate = sample_rate, .channels = 2, .samples = {}};
    for (int n = 0; n < 40000; ++n) {
        sound.samples.push_back(0.5 * std::sin(0.05 * n));
        sound.samples.push_back(0.25 * std::sin(0.11 * n));
    }
    return sound;
}

Sound read_back(const std::string& bytes) {
    const test::TemporaryFolder folder;
    return read_sound(folder.file("sound", bytes));
}

double largest_difference(const Sound& a, const Sound& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        largest = std::max(largest, std::abs(a.samples[i] - b.samples[i]));
    }
    return largest;
}

TEST(SoundFile, HoldsTheSamples) {
    const Sound sound = two_tones(44100.0);
    for (const auto& [format, tolerance] : {std::pair{SoundFormat::wav, 1e-7},
                                            {SoundFormat::flac, 1.3e-7},  // 24 bit
                                            {SoundFormat::ogg, 0.02}}) {
        const std::string bytes = encode_sound(sound, format);
        const Sound read = read_back(bytes);
        EXPECT_EQ(read.sample_rate, 44100.0);
        EXPECT_EQ(read.channels, 2);
        ASSERT_EQ(read.samples.size(), sound.samples.size());
        EXPECT_LE(largest_difference(read, sound), tolerance);
        EXPECT_EQ(encode_sound(sound, format), bytes) << "bytes differ from run to run";
    }
}

TEST(SoundFile, SuffixesNameFormats) {
    EXPECT_EQ(sound_format_of("a.wav"), SoundFormat::wav);
    EXPECT_EQ(sound_format_of("b/a.FlaC"), SoundFormat::flac);
    EXPECT_EQ(sound_format_of("a.b.ogg"), SoundFormat::ogg);
    EXPECT_THROW(sound_format_of("a.mp3"), Error);
    EXPECT_THROW(sound_format_of("wav"), Error);
}

TEST(SoundFile, CountsWhatIsBeyondFullScaleAndFlacClipsIt) {
    const Sound sound{
        .sample_rate = 48000.0, .channels = 1, .samples = {1.0, -1.0, 1.5, -2.0, 0.5}};
    EXPECT_EQ(count_beyond_full_scale(sound), 2U);
    const Sound read = read_back(encode_sound(sound, SoundFormat::flac));
    const double expected[] = {1.0, -1.0, 1.0, -1.0, 0.5};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(read.samples[i], expected[i], 1.3e-7);
    }
}

TEST(SoundFile, RefusesWhatAFormatCannotHold) {
    Sound sound = two_tones(44100.5);
    EXPECT_THROW(encode_sound(sound, SoundFormat::flac), Error);
    sound = two_tones(768000.0);
    EXPECT_THROW(encode_sound(sound, SoundFormat::flac), Error);
    sound = {.sample_rate = 48000.0, .channels = 9, .samples = std::vector<double>(9)};
    EXPECT_THROW(encode_sound(sound, SoundFormat::flac), Error);
    EXPECT_NO_THROW(encode_sound(sound, SoundFormat::wav));
}

}  // namespace
}  // namespace earshot::io
