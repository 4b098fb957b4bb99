// SPDX-License-Identifier: MIT
#include "earshot/io/wav.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>

namespace earshot::io {

namespace {

constexpr int kMaxChannels = 1024;             // libsndfile's limit
constexpr double kMaxSampleRate = 2147483647;  // the header's field, as libsndfile holds it
// The sizes in a RIFF header have 32 bits; the header before the samples is far below 4 KiB.
constexpr std::uint64_t kMaxWavBytes = 0xFFFFFFFFULL - 4096;
constexpr std::size_t kFramesPerBlock = 16384;

struct CloseSound {
    void operator()(SNDFILE* sound) const noexcept { sf_close(sound); }
};
using SoundHandle = std::unique_ptr<SNDFILE, CloseSound>;

// A file in memory for libsndfile. `bytes` has its final capacity before the first call, so that no
// exception passes through C.
struct MemoryFile {
    std::string bytes;
    std::size_t at = 0;
};

sf_count_t memory_size(void* user) {
    return static_cast<sf_count_t>(static_cast<MemoryFile*>(user)->bytes.size());
}

sf_count_t memory_seek(sf_count_t offset, int whence, void* user) {
    auto& file = *static_cast<MemoryFile*>(user);
    const auto base = whence == SEEK_SET   ? sf_count_t{0}
                      : whence == SEEK_CUR ? static_cast<sf_count_t>(file.at)
                                           : static_cast<sf_count_t>(file.bytes.size());
    file.at = static_cast<std::size_t>(std::max(sf_count_t{0}, base + offset));
    return static_cast<sf_count_t>(file.at);
}

sf_count_t memory_read(void* data, sf_count_t count, void* user) {
    auto& file = *static_cast<MemoryFile*>(user);
    const std::size_t left = file.bytes.size() - std::min(file.at, file.bytes.size());
    const std::size_t read = std::min(left, static_cast<std::size_t>(count));
    std::memcpy(data, file.bytes.data() + file.at, read);
    file.at += read;
    return static_cast<sf_count_t>(read);
}

sf_count_t memory_write(const void* data, sf_count_t count, void* user) {
    auto& file = *static_cast<MemoryFile*>(user);
    const std::size_t end = file.at + static_cast<std::size_t>(count);
    if (end > file.bytes.capacity()) {
        return 0;
    }
    file.bytes.resize(std::max(file.bytes.size(), end));
    std::memcpy(file.bytes.data() + file.at, data, static_cast<std::size_t>(count));
    file.at = end;
    return count;
}

sf_count_t memory_tell(void* user) {
    return static_cast<sf_count_t>(static_cast<MemoryFile*>(user)->at);
}

SF_INFO wav_header(const Sound& sound) {
    const double rate = sound.sample_rate;
    if (!(rate >= 1.0 && rate <= kMaxSampleRate && rate == std::floor(rate))) {
        throw Error("sample rate",
                    "a WAV file cannot hold " + std::to_string(rate) + " Hz",
                    "use a whole number of hertz");
    }
    if (sound.channels < 1 || sound.channels > kMaxChannels) {
        throw Error("channels",
                    "a WAV file cannot hold " + std::to_string(sound.channels),
                    "use 1 ... " + std::to_string(kMaxChannels));
    }
    SF_INFO info{};
    info.samplerate = static_cast<int>(rate);
    info.channels = sound.channels;
    info.format = SF_FORMAT_WAV | SF_FORMAT_FLOAT;
    return info;
}

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
    SF_INFO info = wav_header(sound);
    const auto channels = static_cast<std::size_t>(sound.channels);
    EARSHOT_ASSERT(sound.samples.size() % channels == 0);
    if (sound.samples.size() > kMaxWavBytes / sizeof(float)) {
        throw Error("WAV file", "would exceed 4 GiB", "shorten the response or use fewer channels");
    }
    MemoryFile file;
    file.bytes.reserve(sound.samples.size() * sizeof(float) + 4096);
    SF_VIRTUAL_IO memory{memory_size, memory_seek, memory_read, memory_write, memory_tell};
    SoundHandle handle(sf_open_virtual(&memory, SFM_WRITE, &info, &file));
    if (!handle) {
        throw Error("WAV file", std::string("cannot be encoded (") + sf_strerror(nullptr) + ")");
    }
    // The PEAK chunk holds the time of writing.
    sf_command(handle.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    std::vector<float> block;
    const std::size_t block_size = kFramesPerBlock * channels;
    for (std::size_t begin = 0; begin < sound.samples.size(); begin += block_size) {
        const std::size_t count = std::min(block_size, sound.samples.size() - begin);
        block.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            block[i] = static_cast<float>(sound.samples[begin + i]);
        }
        const auto written =
            sf_write_float(handle.get(), block.data(), static_cast<sf_count_t>(count));
        if (written != static_cast<sf_count_t>(count)) {
            throw Error("WAV file", "cannot be encoded");
        }
    }
    handle.reset();  // completes the header
    return std::move(file.bytes);
}

Sound read_sound(const std::filesystem::path& file) {
    SF_INFO info{};
    const SoundHandle handle = open_sound(file, info);
    Sound sound{static_cast<double>(info.samplerate), info.channels, {}};
    // Block by block: the number of frames in a header may be a lie.
    std::vector<double> block(kFramesPerBlock * static_cast<std::size_t>(info.channels));
    const auto block_size = static_cast<sf_count_t>(block.size());
    for (sf_count_t read = block_size; read == block_size;) {
        read = sf_read_double(handle.get(), block.data(), block_size);
        sound.samples.insert(sound.samples.end(), block.begin(), block.begin() + read);
    }
    const auto frames =
        static_cast<sf_count_t>(sound.samples.size() / static_cast<std::size_t>(info.channels));
    const bool has_whole_frames =
        sound.samples.size() % static_cast<std::size_t>(info.channels) == 0;
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
