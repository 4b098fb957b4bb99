// SPDX-License-Identifier: MIT
#include "earshot/io/sound_signal.h"

#include <gtest/gtest.h>

#include <vector>

namespace earshot::io {
namespace {

TEST(SoundSignal, PartsFramesIntoChannelsAndJoinsThem) {
    const Sound sound{.sample_rate = 44100.0, .channels = 2, .samples = {1, -1, 2, -2, 3, -3}};
    const audio::Signal signal = signal_of(sound);
    EXPECT_EQ(signal.sample_rate, 44100);
    EXPECT_EQ(signal.channels, (std::vector<std::vector<double>>{{1, 2, 3}, {-1, -2, -3}}));
    const Sound again = sound_of(signal);
    EXPECT_EQ(again.sample_rate, sound.sample_rate);
    EXPECT_EQ(again.channels, sound.channels);
    EXPECT_EQ(again.samples, sound.samples);
}

}  // namespace
}  // namespace earshot::io
