// SPDX-License-Identifier: MIT
// Scenes that move, played by the engine into a file.
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

constexpr double kRate = 16000.0;

class Play : public testing::Test {
protected:
    Play() {
        write("street.obj",
              "v -500 0 -500\nv 500 0 -500\nv 500 0 500\nv -500 0 500\nf 1 3 2\nf 1 4 3\n");
        // Nearer at a tenth of the speed of sound.
        write("way.csv", "time,x,y,z\n0,55,5,5\n0.5,37.84,5,5\n1,20.68,5,5\n");
        io::Sound tone{.sample_rate = kRate, .channels = 1, .samples = {}};
        for (int n = 0; n < 16000; ++n) {
            tone.samples.push_back(std::sin(2.0 * std::numbers::pi * 900.0 * n / kRate));
        }
        write("dry.wav", io::encode_wav(tone));
    }
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
    void write(const std::string& name, const std::string& text) const {
        io::write_whole_file(folder_.path() / name, text);
    }
    RunResult play(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {"play",
                                              path("street.obj"),
                                              "--listener",
                                              "ear=1,5,5",
                                              "--source",
                                              "car=55,5,5",
                                              "--sample-rate",
                                              "16000",
                                              "-o",
                                              path("wet.wav")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }

    const TemporaryFolder folder_;
};

TEST_F(Play, HearsASourceThatComesNearerAtAHigherFrequency) {
    const RunResult result = play({"--sound",
                                   path("dry.wav"),
                                   "--path-of",
                                   "car=" + path("way.csv"),
                                   "--order",
                                   "0",
                                   "--rays",
                                   "0",
                                   "--no-air-absorption",
                                   "--seconds",
                                   "1"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("1 paths at the end"), std::string::npos) << result.out;
    const io::Sound wet = io::read_sound(path("wet.wav"));
    EXPECT_EQ(wet.sample_rate, kRate);
    ASSERT_EQ(wet.samples.size(), 16000U);
    int crossings = 0;
    for (std::size_t n = 8000; n < 12000; ++n) {
        crossings += wet.samples[n] < 0.0 && wet.samples[n + 1] >= 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(crossings, 250, 1);  // 1000 Hz
    // p(t) = s(t_e) / r(t_e): at 0.75 s it is 55 - 34.32 t_e - 1 m away, t_e = t - r / c.
    const double emission = (0.75 - 54.0 / 343.2) / (1.0 - 0.1);
    double largest = 0.0;
    for (std::size_t n = 11984; n < 12016; ++n) {
        largest = std::max(largest, std::abs(wet.samples[n]));
    }
    EXPECT_NEAR(largest, 1.0 / (54.0 - 34.32 * emission), 0.02 / 30.0);
}

TEST_F(Play, GivesTheSameBytesForAnyThreads) {
    const auto with_threads = [&](const std::string& threads) {
        EXPECT_EQ(play({"--sound",
                        "car=" + path("dry.wav"),
                        "--path-of",
                        "car=" + path("way.csv"),
                        "--seconds",
                        "0.4",
                        "--format",
                        "binaural",
                        "--threads",
                        threads})
                      .status,
                  0);
        return io::read_whole_file(path("wet.wav"));
    };
    EXPECT_EQ(with_threads("1"), with_threads("3"));
}

TEST_F(Play, SaysWhatIsWrong) {
    const auto fails =
        [&](const std::vector<std::string>& more, int status, const std::string& message) {
            EXPECT_TRUE(failed_with(play(more), status, message));
        };
    fails({}, 2, "--sound: is missing");
    fails({"--sound", "cart=" + path("dry.wav")}, 1, "did you mean car?");
    fails({"--sound", path("none.wav")}, 1, "none.wav");
    fails({"--sound", path("dry.wav"), "--sound", path("dry.wav")}, 1, "two recordings");
    fails({"--sound", path("dry.wav"), "--block", "300"}, 2, "--block");
    fails({"--sound", path("dry.wav"), "--to", "eye"}, 1, "no such listener");
    EXPECT_TRUE(failed_with(run_earshot({"play"}), 2, "SCENE: is missing"));
}

}  // namespace
}  // namespace earshot::test
