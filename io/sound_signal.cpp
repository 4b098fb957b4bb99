// SPDX-License-Identifier: MIT
#include "earshot/io/sound_signal.h"

#include <cmath>
#include <cstddef>

namespace earshot::io {

audio::Signal signal_of(const Sound& sound) {
    const auto count = static_cast<std::size_t>(sound.channels);
    audio::Signal signal{.sample_rate = std::llround(sound.sample_rate)};
    signal.channels.resize(count);
    for (std::size_t i = 0; i < sound.samples.size(); ++i) {
        signal.channels[i % count].push_back(sound.samples[i]);
    }
    return signal;
}

Sound sound_of(const audio::Signal& signal) {
    Sound sound{.sample_rate = static_cast<double>(signal.sample_rate),
                .channels = static_cast<int>(signal.channels.size()),
                .samples = {}};
    for (std::size_t n = 0; n < signal.channels.front().size(); ++n) {
        for (const auto& channel : signal.channels) {
            sound.samples.push_back(channel[n]);
        }
    }
    return sound;
}

}  // namespace earshot::io
