// SPDX-License-Identifier: MIT
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <cmath>
#include <filesystem>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

class Auralize : public testing::Test {
protected:
    std::string write(const std::string& name,
                      int channels,
                      std::vector<double> samples,
                      double sample_rate = 48000.0) const {
        const fs::path file = folder_.path() / name;
        io::write_whole_file(
            file,
            io::encode_wav(
                {.sample_rate = sample_rate, .channels = channels, .samples = std::move(samples)}));
        return file.string();
    }
    std::string out() const { return (folder_.path() / "wet.wav").string(); }

    const TemporaryFolder folder_;
};

void expect_samples(const io::Sound& sound, const std::vector<double>& expected) {
    ASSERT_EQ(sound.samples.size(), expected.size());
    for (std::size_t n = 0; n < expected.size(); ++n) {
        EXPECT_NEAR(sound.samples[n], expected[n], 1e-6) << n;
    }
}

TEST_F(Auralize, AMonoSoundGetsTheChannelsOfTheResponse) {
    const RunResult result = run_earshot({"auralize",
                                          write("dry.wav", 1, {1.0, 0.5}),
                                          write("ir.wav", 2, {1.0, 0.0, 0.0, -1.0}),
                                          "-o",
                                          out()});
    ASSERT_EQ(result.status, 0) << result.err;
    const io::Sound wet = io::read_sound(out());
    EXPECT_EQ(wet.channels, 2);
    expect_samples(wet, {1.0, 0.0, 0.5, -1.0, 0.0, -0.5});
}

TEST_F(Auralize, SeveralChannelsGoThroughAResponseOfOneOrOfAsMany) {
    const std::string dry = write("dry.wav", 2, {1.0, 0.5});
    ASSERT_EQ(run_earshot({"auralize", dry, write("one.wav", 1, {2.0}), "-o", out()}).status, 0);
    expect_samples(io::read_sound(out()), {2.0, 1.0});
    ASSERT_EQ(run_earshot({"auralize", dry, write("two.wav", 2, {2.0, 4.0}), "-o", out()}).status,
              0);
    expect_samples(io::read_sound(out()), {2.0, 2.0});
    EXPECT_TRUE(
        failed_with(run_earshot({"auralize", dry, write("three.wav", 3, {1, 1, 1}), "-o", out()}),
                    1,
                    "3 channels"));
}

TEST_F(Auralize, ScalesToAPeakIfAsked) {
    const std::string dry = write("dry.wav", 1, {0.1, -0.2});
    const std::string response = write("ir.wav", 1, {1.0});
    ASSERT_EQ(run_earshot({"auralize", dry, response, "-o", out(), "--peak", "0"}).status, 0);
    expect_samples(io::read_sound(out()), {0.5, -1.0});
}

TEST_F(Auralize, ResponsesOfFramesFollowEachOther) {
    const std::string dry = write("dry.wav", 1, std::vector<double>(1000, 0.5));
    ASSERT_EQ(run_earshot({"auralize",
                           dry,
                           write("a.wav", 1, {1.0}),
                           write("b.wav", 1, {-1.0}),
                           "-o",
                           out(),
                           "--quiet"})
                  .status,
              0);
    const io::Sound wet = io::read_sound(out());
    EXPECT_NEAR(wet.samples.front(), 0.5, 1e-6);
    EXPECT_NEAR(wet.samples[500], 0.0, 1e-6);
    EXPECT_NEAR(wet.samples.back(), -0.5, 1e-6);
}

TEST_F(Auralize, WarnsThatThePitchOfResponsesOfFramesDoesNotFollowMotion) {
    const std::string dry = write("dry.wav", 1, std::vector<double>(1000, 0.5));
    const std::string first = write("a.wav", 1, {1.0});
    const std::string second = write("b.wav", 1, {-1.0});
    EXPECT_NE(
        run_earshot({"auralize", dry, first, second, "-o", out()})
            .err.find("warning: " + first + ": 2 responses are cross-faded, so that the pitch"),
        std::string::npos);
    EXPECT_EQ(run_earshot({"auralize", dry, first, "-o", out()}).err, "");
    EXPECT_EQ(run_earshot({"auralize", dry, first, second, "-o", out(), "--quiet"}).err, "");
}

TEST_F(Auralize, SourcesAreMixedAndTheShorterEndsFirst) {
    const std::string voice = write("voice.wav", 1, {1.0, 0.5});
    const std::string flute = write("flute.wav", 1, {0.25, 0.0, 0.125, 0.5});
    const std::string near = write("near.wav", 2, {1.0, 0.0});
    const std::string far = write("far.wav", 2, {0.0, 1.0, 0.0, -1.0});
    ASSERT_EQ(run_earshot({"auralize", voice, near, "--mix", flute, far, "-o", out()}).status, 0);
    // Left: the voice. Right: the flute, and again a sample later, negative.
    expect_samples(io::read_sound(out()),
                   {1.0, 0.25, 0.5, -0.25, 0.0, 0.125, 0.0, 0.375, 0.0, -0.5});
    ASSERT_EQ(run_earshot({"auralize",
                           voice,
                           near,
                           "--mix",
                           flute,
                           near,
                           "--mix",
                           flute,
                           near,
                           "--gain",
                           "0",
                           "--gain",
                           "20",
                           "--gain",
                           "-20",
                           "-o",
                           out()})
                  .status,
              0);
    expect_samples(io::read_sound(out()), {3.525, 0.0, 0.5, 0.0, 1.2625, 0.0, 5.05, 0.0});
    ASSERT_EQ(run_earshot({"auralize", voice, near, "--gain", "-20", "-o", out()}).status, 0);
    expect_samples(io::read_sound(out()), {0.1, 0.0, 0.05, 0.0});

    EXPECT_TRUE(failed_with(
        run_earshot({"auralize", voice, near, "--mix", flute, "-o", out()}), 2, "--mix"));
    EXPECT_TRUE(
        failed_with(run_earshot({"auralize", voice, near, "--mix", flute, voice, "-o", out()}),
                    1,
                    "voice.wav: makes 1 channels"));
    EXPECT_TRUE(failed_with(
        run_earshot({"auralize", voice, near, "--gain", "1", "--gain", "2", "-o", out()}),
        2,
        "given 2 times for 1 sources"));
}

// A tone through an impulse is that tone at any rate.
TEST_F(Auralize, ResamplesTheRecordingToTheResponsesAndTheResultAsAsked) {
    const auto tone = [](double rate, std::size_t size) {
        std::vector<double> samples(size);
        for (std::size_t n = 0; n < size; ++n) {
            samples[n] = 0.5 * std::sin(6.283185307179586 * 440.0 * double(n) / rate);
        }
        return samples;
    };
    const std::string dry = write("dry.wav", 1, tone(44100.0, 4410), 44100.0);
    const std::string response = write("ir.wav", 1, {1.0}, 48000.0);
    for (const auto& [option, rate] :
         {std::pair<std::string, double>{"", 48000.0}, {"32000", 32000.0}, {"96000", 96000.0}}) {
        std::vector<std::string> arguments = {"auralize", dry, response, "-o", out()};
        if (!option.empty()) {
            arguments.insert(arguments.end(), {"--sample-rate", option});
        }
        const RunResult result = run_earshot(arguments);
        ASSERT_EQ(result.status, 0) << result.err;
        const io::Sound wet = io::read_sound(out());
        EXPECT_EQ(wet.sample_rate, rate);
        ASSERT_EQ(wet.samples.size(), std::size_t(0.1 * rate));
        const auto expected = tone(rate, wet.samples.size());
        for (std::size_t n = 300; n + 300 < expected.size(); ++n) {
            ASSERT_NEAR(wet.samples[n], expected[n], 1e-4) << rate << " Hz, sample " << n;
        }
    }
}

TEST_F(Auralize, TheSuffixNamesTheFormat) {
    const std::string dry = write("dry.wav", 1, {0.5, -0.25, 0.125});
    const std::string response = write("ir.wav", 1, {1.0});
    const std::string flac = (folder_.path() / "wet.FLAC").string();
    ASSERT_EQ(run_earshot({"auralize", dry, response, "-o", flac}).status, 0);
    EXPECT_EQ(io::read_whole_file(flac).substr(0, 4), "fLaC");
    expect_samples(io::read_sound(flac), {0.5, -0.25, 0.125});
    const std::string ogg = (folder_.path() / "wet.ogg").string();
    ASSERT_EQ(run_earshot({"auralize", flac, response, "-o", ogg}).status, 0);  // reads FLAC
    EXPECT_EQ(io::read_whole_file(ogg).substr(0, 4), "OggS");
    ASSERT_EQ(run_earshot({"auralize", ogg, response, "-o", out()}).status, 0);  // reads OGG
    EXPECT_EQ(io::read_sound(out()).samples.size(), 3U);
    for (const char* name : {"wet.mp3", "wet", "wet.wav.txt"}) {
        const fs::path file = folder_.path() / name;
        EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, response, "-o", file.string()}),
                                1,
                                "use .wav, .flac or .ogg"));
        EXPECT_FALSE(fs::exists(file));
    }
}

TEST_F(Auralize, WarnsOfSamplesThatAFileClips) {
    const std::string dry = write("dry.wav", 1, {2.0, -0.25, -3.0});
    const std::string response = write("ir.wav", 1, {1.0});
    const std::string flac = (folder_.path() / "wet.flac").string();
    const RunResult result = run_earshot({"auralize", dry, response, "-o", flac});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("warning: " + flac + ": 2 samples exceed full scale"),
              std::string::npos)
        << result.err;
    expect_samples(io::read_sound(flac), {1.0, -0.25, -1.0});
    EXPECT_EQ(run_earshot({"auralize", dry, response, "-o", out()}).err, "");
    EXPECT_EQ(run_earshot({"auralize", dry, response, "-o", flac, "--gain", "-10"}).err, "");
}

TEST_F(Auralize, RefusesWhatDoesNotFit) {
    const std::string dry = write("dry.wav", 1, {1.0});
    const std::string response = write("ir.wav", 1, {1.0}, 44100.0);
    EXPECT_TRUE(
        failed_with(run_earshot({"auralize", dry, dry, response, "-o", out()}), 1, "44100 Hz"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, "no.wav", "-o", out()}), 1, "no.wav"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, "-o", out()}), 2, "RESPONSE"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, dry}), 2, "output"));
    EXPECT_TRUE(failed_with(
        run_earshot({"auralize", dry, dry, "-o", (folder_.path() / "no" / "wet.wav").string()}),
        1,
        "no"));
    EXPECT_FALSE(fs::exists(out()));
}

}  // namespace
}  // namespace earshot::test
