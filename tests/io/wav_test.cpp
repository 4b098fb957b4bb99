// SPDX-License-Identifier: MIT
#include "earshot/io/wav.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>

namespace earshot::io {
namespace {

namespace fs = std::filesystem;

class WavFile : public ::testing::Test {
protected:
    void write(const std::string& bytes) const {
        std::ofstream(path_, std::ios::binary).write(bytes.data(), std::ssize(bytes));
    }
    std::string error_of_reading() const {
        try {
            read_sound(path_);
        } catch (const Error& error) {
            return error.line();
        }
        return "no error";
    }
    const test::TemporaryFolder folder_;
    const fs::path path_ = folder_.path() / "sound.wav";
};

Sound three_channels() {
    Sound sound{44100.0, 3, {}};
    for (int i = 0; i < 3 * 20000; ++i) {
        sound.samples.push_back(std::sin(0.01 * i) * (i % 3 + 1));
    }
    return sound;
}

template <typename T>
T field(const std::string& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

TEST(EncodeWav, WritesSamplesAndNoTimeStamp) {
    const std::string bytes = encode_wav({8000.0, 1, {0.5, -1.0, 2.5}});
    // RIFF size WAVE, then chunks: name, size, content.
    EXPECT_EQ(bytes.substr(0, 4), "RIFF");
    EXPECT_EQ(field<std::uint32_t>(bytes, 4), bytes.size() - 8);
    EXPECT_EQ(bytes.substr(8, 4), "WAVE");
    std::string chunks;
    std::string data;
    std::string padding;
    for (std::size_t at = 12; at < bytes.size(); at += 8 + field<std::uint32_t>(bytes, at + 4)) {
        const std::string name = bytes.substr(at, 4);
        chunks += name;
        if (name == "fmt ") {
            EXPECT_EQ(field<std::uint16_t>(bytes, at + 8), 3);       // IEEE float
            EXPECT_EQ(field<std::uint16_t>(bytes, at + 10), 1);      // channels
            EXPECT_EQ(field<std::uint32_t>(bytes, at + 12), 8000U);  // sample rate
            EXPECT_EQ(field<std::uint16_t>(bytes, at + 22), 32);     // bits
        }
        if (name == "PAD ") {
            padding += bytes.substr(at + 8, field<std::uint32_t>(bytes, at + 4));
        }
        if (name == "data") {
            data = bytes.substr(at + 8, field<std::uint32_t>(bytes, at + 4));
        }
    }
    EXPECT_EQ(chunks, "fmt factPAD data");
    // Where libsndfile would put its PEAK chunk with the time of writing.
    EXPECT_EQ(padding, std::string(padding.size(), '\0'));
    ASSERT_EQ(data.size(), 12U);
    EXPECT_EQ(field<float>(data, 0), 0.5F);
    EXPECT_EQ(field<float>(data, 4), -1.0F);
    EXPECT_EQ(field<float>(data, 8), 2.5F);
}

TEST(EncodeWav, RefusesWhatAHeaderCannotHold) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double rate : {0.0, -48000.0, 44100.5, 3e9, nan}) {
        EXPECT_THROW(encode_wav({rate, 1, {0.0}}), Error) << rate;
    }
    EXPECT_THROW(encode_wav({48000.0, 0, {}}), Error);
    EXPECT_THROW(encode_wav({48000.0, 1025, {}}), Error);
}

TEST_F(WavFile, ReadsBackWhatWasWrittenToSinglePrecision) {
    const Sound sound = three_channels();
    write(encode_wav(sound));
    const Sound back = read_sound(path_);
    EXPECT_EQ(back.sample_rate, 44100.0);
    EXPECT_EQ(back.channels, 3);
    ASSERT_EQ(back.samples.size(), sound.samples.size());
    for (std::size_t i = 0; i < sound.samples.size(); ++i) {
        ASSERT_EQ(back.samples[i], static_cast<double>(static_cast<float>(sound.samples[i])));
    }
}

TEST_F(WavFile, OfNoSamplesIsStillASoundFile) {
    write(encode_wav({48000.0, 1, {}}));
    EXPECT_TRUE(read_sound(path_).samples.empty());
}

TEST_F(WavFile, CutOffAnywhereIsAnError) {
    const std::string whole = encode_wav(three_channels());
    for (const std::size_t kept : {std::size_t{1},
                                   std::size_t{11},
                                   std::size_t{30},
                                   std::size_t{50},
                                   std::size_t{1000},
                                   whole.size() - 1}) {
        write(whole.substr(0, kept));
        EXPECT_NE(error_of_reading().find(path_.string() + ": "), std::string::npos) << kept;
    }
}

// Three samples of 16 bits in two channels.
TEST_F(WavFile, ThatEndsWithinAFrameIsAnError) {
    const auto word = [](std::uint32_t value, std::size_t size) {
        std::string bytes(sizeof value, '\0');
        std::memcpy(bytes.data(), &value, sizeof value);
        return bytes.substr(0, size);
    };
    const auto file = [&](std::uint32_t data_bytes) {
        return "RIFF" + word(36 + data_bytes, 4) + "WAVEfmt " + word(16, 4) + word(1, 2) +
               word(2, 2) + word(8000, 4) + word(32000, 4) + word(4, 2) + word(16, 2) + "data" +
               word(data_bytes, 4) + std::string(data_bytes, '\1');
    };
    write(file(8));
    EXPECT_EQ(read_sound(path_).samples.size(), 4U);
    write(file(6));
    EXPECT_NE(error_of_reading().find("cut off or damaged"), std::string::npos);
}

TEST_F(WavFile, ThatIsNotSoundIsAnError) {
    write("v 0 0 0\nv 1 0 0\n");
    EXPECT_NE(error_of_reading().find("cannot be read as sound"), std::string::npos);
    write("");
    EXPECT_NE(error_of_reading().find("cannot be read as sound"), std::string::npos);
}

TEST_F(WavFile, WithSamplesThatAreNotFiniteIsAnError) {
    write(encode_wav({48000.0, 1, {0.0, std::numeric_limits<double>::infinity()}}));
    EXPECT_NE(error_of_reading().find("not finite"), std::string::npos);
}

TEST_F(WavFile, ThatIsMissingOrAFolderIsAnError) {
    EXPECT_NE(error_of_reading().find("no such file"), std::string::npos);
    EXPECT_THROW(read_sound(folder_.path()), Error);
}

}  // namespace
}  // namespace earshot::io
