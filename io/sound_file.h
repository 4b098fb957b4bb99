// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/wav.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace earshot::io {

/// Sound files that can be written.
enum class SoundFormat {
    wav,   ///< 32-bit float
    flac,  ///< 24 bit, without loss
    ogg,   ///< Vorbis, lossy
};

/// The format that a file's suffix names, in any case. Throws Error for any other suffix.
SoundFormat sound_format_of(const std::filesystem::path& file);

/// The bytes of a sound file. The same samples give the same bytes on any day; those of WAV on any
/// machine too. FLAC holds -1 ... 1 and clips what is beyond (see count_beyond_full_scale()).
/// Throws Error if the format cannot hold the sample rate, the number of channels or the length.
std::string encode_sound(const Sound& sound, SoundFormat format);

/// The number of samples beyond -1 ... 1.
std::size_t count_beyond_full_scale(const Sound& sound) noexcept;

}  // namespace earshot::io
