// SPDX-License-Identifier: MIT
// Recordings played in a scene that moves.
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

class AuralizeScene : public testing::Test {
protected:
    AuralizeScene() {
        // A hall of 60 x 10 x 10 m.
        write("hall.obj",
              "v 0 0 0\nv 60 0 0\nv 0 10 0\nv 60 10 0\nv 0 0 10\nv 60 0 10\nv 0 10 10\nv 60 10 10\n"
              "f 1 5 6 2\nf 3 4 8 7\nf 1 2 4 3\nf 5 7 8 6\nf 1 3 7 5\nf 2 6 8 4\n");
        // Nearer at a tenth of the speed of sound.
        write("way.csv", "time,x,y,z\n0,55,5,5\n0.5,37.84,5,5\n1,20.68,5,5\n");
    }
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
    void write(const std::string& name, const std::string& text) const {
        io::write_whole_file(folder_.path() / name, text);
    }
    std::string tone(const std::string& name, int channels = 1) const {
        io::Sound sound{.sample_rate = kRate, .channels = channels, .samples = {}};
        for (int n = 0; n < 8000; ++n) {
            for (int channel = 0; channel < channels; ++channel) {
                sound.samples.push_back(std::sin(2.0 * std::numbers::pi * 900.0 * n / kRate));
            }
        }
        write(name, io::encode_wav(sound));
        return path(name);
    }
    RunResult play(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {"auralize",
                                              tone("dry.wav"),
                                              "--scene",
                                              path("hall.obj"),
                                              "--listener",
                                              "ear=1,5,5",
                                              "--source",
                                              "car=55,5,5",
                                              "--rays",
                                              "0",
                                              "-o",
                                              path("wet.wav")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }

    const TemporaryFolder folder_;
};

TEST_F(AuralizeScene, HearsASourceThatComesNearerAtAHigherFrequency) {
    const RunResult result =
        play({"--path-of", "car=" + path("way.csv"), "--order", "0", "--no-air-absorption"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("; 1 paths at 11 instants"), std::string::npos) << result.out;
    const io::Sound wet = io::read_sound(path("wet.wav"));
    EXPECT_EQ(wet.sample_rate, kRate);
    int crossings = 0;
    for (std::size_t n = 4000; n < 8000; ++n) {
        crossings += wet.samples[n] < 0.0 && wet.samples[n + 1] >= 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(crossings, 250, 1);  // 1000 Hz
}

TEST_F(AuralizeScene, GivesTheSameBytesForAnyThreads) {
    const std::vector<std::string> options = {
        "--path-of", "car=" + path("way.csv"), "--order", "1", "--format", "ambisonic:1"};
    auto with_threads = [&](const std::string& threads) {
        std::vector<std::string> all = options;
        all.insert(all.end(), {"--threads", threads});
        EXPECT_EQ(play(all).status, 0);
        return io::read_whole_file(path("wet.wav"));
    };
    EXPECT_EQ(with_threads("1"), with_threads("3"));
}

TEST_F(AuralizeScene, MixesSourcesByName) {
    const std::vector<std::string> one = {"--source", "bell=30,5,5", "--order", "0"};
    EXPECT_TRUE(failed_with(play(one), 1, "has 2 sources; name one of them with --from"));
    std::vector<std::string> both = one;
    both.insert(both.end(), {"--from", "car", "--mix", tone("bell.wav"), "bell"});
    const RunResult result = play(both);
    EXPECT_EQ(result.status, 0) << result.err;
    both.back() = "bel";
    EXPECT_TRUE(failed_with(play(both), 1, "did you mean bell?"));
}

TEST_F(AuralizeScene, SaysWhatIsWrong) {
    const auto fails = [&](std::vector<std::string> more, int status, const std::string& message) {
        EXPECT_TRUE(failed_with(play(more), status, message));
    };
    fails({"--path-of", "car"}, 2, "NAME=FILE");
    fails({"--path-of", "cart=" + path("way.csv")}, 1, "did you mean car?");
    fails({"--path-of", "car=" + path("none.csv")}, 1, "none.csv");
    write("back.csv", "0,55,5,5\n0,50,5,5\n");
    fails({"--path-of", "car=" + path("back.csv")}, 1, "back.csv: times do not ascend");
    write("fast.csv", "0,55,5,5\n0.1,5,5,5\n");
    fails({"--path-of", "car=" + path("fast.csv")}, 1, "0.9 of the speed of sound");
    write("words.csv", "0,55,5,5\nsoon,5,5,5\n");
    fails({"--path-of", "car=" + path("words.csv")}, 1, "line 2 is not a point");
    fails({path("dry.wav")}, 2, "--scene takes the place of");
    fails({"--step", "0"}, 2, "--step");
    EXPECT_TRUE(failed_with(run_earshot({"auralize", tone("dry.wav"), "-o", path("wet.wav")}),
                            2,
                            "RESPONSE: is missing"));
    EXPECT_TRUE(failed_with(run_earshot({"auralize",
                                         tone("two.wav", 2),
                                         "--scene",
                                         path("hall.obj"),
                                         "--listener",
                                         "1,5,5",
                                         "--source",
                                         "9,5,5",
                                         "-o",
                                         path("wet.wav")}),
                            1,
                            "a source plays a mono recording"));
}

}  // namespace
}  // namespace earshot::test
