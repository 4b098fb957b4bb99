// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/wav.h"

#include <gtest/gtest.h>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::test {

/// The bytes of a WAV file: a sine of amplitude 1, the same in all channels.
inline std::string sine_wav(double sample_rate,
                            double frequency_hz,
                            std::size_t samples,
                            int channels = 1) {
    io::Sound sound{.sample_rate = sample_rate, .channels = channels, .samples = {}};
    for (std::size_t n = 0; n < samples; ++n) {
        const double phase =
            2.0 * std::numbers::pi * frequency_hz * static_cast<double>(n) / sample_rate;
        sound.samples.insert(
            sound.samples.end(), static_cast<std::size_t>(channels), std::sin(phase));
    }
    return io::encode_wav(sound);
}

/// A listener `ear` at (1, 5, 5) that a source `car` comes nearer from (55, 5, 5).
class MovingSource : public testing::Test {
protected:
    static constexpr double kSampleRate = 16000.0;

    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    /// Writes a file and returns its path.
    std::string write(const std::string& name, std::string_view bytes) const {
        return folder_.file(name, bytes).string();
    }

    /// The value of --path-of: nearer at a tenth of the speed of sound.
    std::string way() const {
        return "car=" + write("way.csv", "time,x,y,z\n0,55,5,5\n0.5,37.84,5,5\n1,20.68,5,5\n");
    }

    /// The path of a recording of a tone of 900 Hz.
    std::string tone(const std::string& name, double seconds, int channels = 1) const {
        return write(
            name,
            sine_wav(
                kSampleRate, 900.0, static_cast<std::size_t>(seconds * kSampleRate), channels));
    }

    /// Runs the program with emitters and an output, wet.wav, behind `first`.
    RunResult play(std::vector<std::string> first, const std::vector<std::string>& more) const {
        first.insert(first.end(),
                     {"--listener", "ear=1,5,5", "--source", "car=55,5,5", "-o", path("wet.wav")});
        first.insert(first.end(), more.begin(), more.end());
        return run_earshot(first);
    }

    const TemporaryFolder folder_;
};

/// How often the sound crosses zero upwards from sample `begin` to sample `end`.
inline int upward_crossings(const io::Sound& sound, std::size_t begin, std::size_t end) {
    int crossings = 0;
    for (std::size_t n = begin; n < end; ++n) {
        crossings += sound.samples[n] < 0.0 && sound.samples[n + 1] >= 0.0 ? 1 : 0;
    }
    return crossings;
}

}  // namespace earshot::test
