// SPDX-License-Identifier: MIT
#include "earshot/io/sound_file.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/io/internal/ogg_pages.h"
#include "earshot/io/internal/sound_handle.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace earshot::io {

namespace {

// The sizes in a RIFF header have 32 bits; the header before the samples is far below 4 KiB.
constexpr std::uint64_t kMaxWavBytes = 0xFFFFFFFFULL - 4096;
constexpr std::size_t kFramesPerBlock = 16384;

/// What libsndfile and the formats allow.
struct FormatLimits {
    const char* name = "";  ///< in messages
    const char* suffix = "";
    int format = 0;  ///< libsndfile's number
    int max_channels = 0;
    double max_sample_rate = 0.0;  ///< hertz
    double quality = 0.0;          ///< of a lossy format, 0 ... 1; 0: not lossy
};

constexpr std::array<FormatLimits, 3> kFormats = {
    {{"WAV", ".wav", SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1024, 2147483647, 0.0},
     {"FLAC", ".flac", SF_FORMAT_FLAC | SF_FORMAT_PCM_24, 8, 655350, 0.0},
     {"OGG", ".ogg", SF_FORMAT_OGG | SF_FORMAT_VORBIS, 255, 192000, 0.6}}};

const FormatLimits& limits_of(SoundFormat format) {
    return kFormats.at(static_cast<std::size_t>(format));
}

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

SF_INFO header_of(const Sound& sound, const FormatLimits& limits) {
    const double rate = sound.sample_rate;
    const std::string file = std::string(limits.name) + " file";
    if (!(rate >= 1.0 && rate <= limits.max_sample_rate && rate == std::floor(rate))) {
        throw Error("sample rate",
                    "a " + file + " cannot hold " + std::to_string(rate) + " Hz",
                    "use a whole number of hertz up to " +
                        std::to_string(std::llround(limits.max_sample_rate)));
    }
    if (sound.channels < 1 || sound.channels > limits.max_channels) {
        throw Error("channels",
                    "a " + file + " cannot hold " + std::to_string(sound.channels),
                    "use 1 ... " + std::to_string(limits.max_channels));
    }
    SF_INFO info{};
    info.samplerate = static_cast<int>(rate);
    info.channels = sound.channels;
    info.format = limits.format;
    return info;
}

void write_samples(SNDFILE* file, const Sound& sound, const FormatLimits& limits) {
    std::vector<float> block;
    const std::size_t block_size = kFramesPerBlock * static_cast<std::size_t>(sound.channels);
    for (std::size_t begin = 0; begin < sound.samples.size(); begin += block_size) {
        const std::size_t count = std::min(block_size, sound.samples.size() - begin);
        block.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            block[i] = static_cast<float>(sound.samples[begin + i]);
        }
        const auto written = sf_write_float(file, block.data(), static_cast<sf_count_t>(count));
        if (written != static_cast<sf_count_t>(count)) {
            throw Error(std::string(limits.name) + " file", "cannot be encoded");
        }
    }
}

}  // namespace

SoundFormat sound_format_of(const std::filesystem::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    for (std::size_t i = 0; i < kFormats.size(); ++i) {
        if (suffix == kFormats[i].suffix) {
            return static_cast<SoundFormat>(i);
        }
    }
    throw Error(file.string(),
                suffix.empty() ? "has no suffix that names a format of sound"
                               : "sound cannot be written as " + suffix,
                "use .wav, .flac or .ogg");
}

std::string encode_sound(const Sound& sound, SoundFormat format) {
    const FormatLimits& limits = limits_of(format);
    const std::string name = std::string(limits.name) + " file";
    SF_INFO info = header_of(sound, limits);
    EARSHOT_ASSERT(sound.samples.size() % static_cast<std::size_t>(sound.channels) == 0);
    if (sound.samples.size() > kMaxWavBytes / sizeof(float)) {
        throw Error(name, "would exceed 4 GiB", "shorten the response or use fewer channels");
    }
    MemoryFile file;
    // FLAC and Vorbis take less than floats do, but for their headers, which grow with the
    // channels.
    file.bytes.reserve(sound.samples.size() * sizeof(float) + 4096 +
                       (format == SoundFormat::wav ? 0 : 65536));
    SF_VIRTUAL_IO memory{memory_size, memory_seek, memory_read, memory_write, memory_tell};
    SoundHandle handle(sf_open_virtual(&memory, SFM_WRITE, &info, &file));
    if (!handle) {
        throw Error(name, std::string("cannot be encoded (") + sf_strerror(nullptr) + ")");
    }
    // The PEAK chunk of WAV holds the time of writing.
    sf_command(handle.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    if (format == SoundFormat::flac) {
        sf_command(handle.get(), SFC_SET_CLIPPING, nullptr, SF_TRUE);
    }
    if (limits.quality > 0.0) {
        double quality = limits.quality;
        sf_command(handle.get(), SFC_SET_VBR_ENCODING_QUALITY, &quality, sizeof(quality));
    }
    write_samples(handle.get(), sound, limits);
    handle.reset();  // completes the header
    return format == SoundFormat::ogg ? with_serial_number(std::move(file.bytes), 1)
                                      : std::move(file.bytes);
}

std::size_t count_beyond_full_scale(const Sound& sound) noexcept {
    return static_cast<std::size_t>(
        std::count_if(sound.samples.begin(), sound.samples.end(), [](double sample) {
            return std::abs(sample) > 1.0;
        }));
}

}  // namespace earshot::io
