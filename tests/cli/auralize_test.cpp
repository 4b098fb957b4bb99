// SPDX-License-Identifier: MIT
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include "run_earshot.h"
#include <cmath>
#include <filesystem>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

class Auralize : public testing::Test {
protected:
    Auralize() { fs::create_directories(folder_); }
    ~Auralize() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    std::string write(const std::string& name,
                      int channels,
                      std::vector<double> samples,
                      double sample_rate = 48000.0) const {
        const fs::path file = folder_ / name;
        io::write_whole_file(
            file,
            io::encode_wav(
                {.sample_rate = sample_rate, .channels = channels, .samples = std::move(samples)}));
        return file.string();
    }
    std::string out() const { return (folder_ / "wet.wav").string(); }

    const fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("earshot_auralize_" +
         std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
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

TEST_F(Auralize, RefusesWhatDoesNotFit) {
    const std::string dry = write("dry.wav", 1, {1.0});
    const std::string response = write("ir.wav", 1, {1.0}, 44100.0);
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, response, "-o", out()}), 1, "44100 Hz"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, "no.wav", "-o", out()}), 1, "no.wav"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, "-o", out()}), 2, "RESPONSE"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize", dry, dry}), 2, "output"));
    EXPECT_TRUE(failed_with(
        run_earshot({"auralize", dry, dry, "-o", (folder_ / "no" / "wet.wav").string()}), 1, "no"));
    EXPECT_FALSE(fs::exists(out()));
}

}  // namespace
}  // namespace earshot::test
