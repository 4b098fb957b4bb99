// SPDX-License-Identifier: MIT
#include "earshot/io/wav.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/sound_handle.h"
#include "earshot/io/sound_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

namespace earshot::io {

namespace {

constexpr std::size_t kSamplesPerBlock = 65536;  // of all channels, of which there are fewer
// Compressed formats hold hours of silence in a few bytes. 46 minutes of one channel at 48 kHz.
constexpr std::size_t kMaxSamplesRead = std::size_t{1} << 27U;

// A RIFF file says how long it is, and libsndfile quietly reads less where that is more than there
// is. Other formats are checked by the number of frames they promise.
bool riff_is_cut_off(const std::filesystem::path& file) {
    std::array<unsigned char, 8> head{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(head.data()), head.size());
    if (!stream || std::memcmp(head.data(), "RIFF", 4) != 0) {
        return false;
    }
    std::uint64_t promised = 0;  // little-endian
    for (std::size_t i = 8; i-- > 4;) {
        promised = promised << 8U | head[i];
    }
    // Programs that stream to a pipe leave all bits set.
    std::error_code error;
    return promised != 0xFFFFFFFFULL && promised + 8 > std::filesystem::file_size(file, error);
}

SoundHandle open_sound(const std::filesystem::path& file, SF_INFO& info) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) {
        throw Error(file.string(), "no such file", "check the path");
    }
    if (!std::filesystem::is_regular_file(file, error)) {
        throw Error(file.string(), "is not a file", "give a sound file");
    }
    if (riff_is_cut_off(file)) {
        throw Error(file.string(), "is truncated", "copy or export it again");
    }
    SoundHandle sound(sf_open(file.c_str(), SFM_READ, &info));
    if (!sound) {
        std::string why = sf_strerror(nullptr);
        while (!why.empty() && (why.back() == '.' || why.back() == '\n')) {
            why.pop_back();
        }
        throw Error(file.string(),
                    "cannot be read as sound (" + why + ")",
                    "give a WAV, FLAC, AIFF or other sound file");
    }
    return sound;
}

}  // namespace

std::string encode_wav(const Sound& sound) {
    return encode_sound(sound, SoundFormat::wav);
}

Sound read_sound(const std::filesystem::path& file) {
    SF_INFO info{};
    const SoundHandle handle = open_sound(file, info);
    Sound sound{static_cast<double>(info.samplerate), info.channels, {}};
    // Block by block: the number of frames in a header may be a lie.
    const auto channels = static_cast<std::size_t>(info.channels);
    std::vector<double> block(kSamplesPerBlock / channels * channels);
    const auto block_size = static_cast<sf_count_t>(block.size());
    for (sf_count_t read = block_size; read == block_size;) {
        read = sf_read_double(handle.get(), block.data(), block_size);
        if (static_cast<std::size_t>(read) > kMaxSamplesRead - sound.samples.size()) {
            throw Error(file.string(),
                        "holds more than " + std::to_string(kMaxSamplesRead) + " samples",
                        "cut it, or reduce its channels or its sample rate");
        }
        sound.samples.insert(sound.samples.end(), block.begin(), block.begin() + read);
    }
    const auto frames = static_cast<sf_count_t>(sound.samples.size() / channels);
    const bool has_whole_frames = sound.samples.size() % channels == 0;
    if (sf_error(handle.get()) != SF_ERR_NO_ERROR || frames < info.frames || !has_whole_frames) {
        throw Error(file.string(), "is cut off or damaged", "copy or export it again");
    }
    if (!std::all_of(sound.samples.begin(), sound.samples.end(), [](double sample) {
            return std::isfinite(sample);
        })) {
        throw Error(file.string(), "holds samples that are not finite", "export it again");
    }
    return sound;
}

}  // namespace earshot::io
