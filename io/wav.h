// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace earshot::io {

/// Interleaved samples of a sound file.
struct Sound {
    double sample_rate = 48000.0;  ///< hertz
    int channels = 1;
    std::vector<double> samples;  ///< frame after frame
};

/// The bytes of a 32-bit float WAV file. The same samples give the same bytes on any day and
/// machine (no time stamp). Throws Error if the sample rate is not a whole number in 1..2^31-1.
std::string encode_wav(const Sound& sound);

/// Reads any file libsndfile understands. Throws Error naming the file.
Sound read_sound(const std::filesystem::path& file);

}  // namespace earshot::io
