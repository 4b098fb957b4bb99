// SPDX-License-Identifier: MIT
// Recordings played in a scene that moves.
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include "moving_source.h"
#include <string>
#include <vector>

namespace earshot::test {
namespace {

class AuralizeScene : public MovingSource {
protected:
    RunResult play(const std::vector<std::string>& more) const { return play_of(dry_, more); }
    RunResult play_of(const std::string& recording, const std::vector<std::string>& more) const {
        return MovingSource::play({"auralize", recording, "--scene", hall_, "--rays", "0"}, more);
    }

    const std::string dry_ = tone("dry.wav", 0.5);

private:
    // 60 x 10 x 10 m.
    const std::string hall_ =
        write("hall.obj",
              "v 0 0 0\nv 60 0 0\nv 0 10 0\nv 60 10 0\nv 0 0 10\nv 60 0 10\nv 0 10 10\nv 60 10 10\n"
              "f 1 5 6 2\nf 3 4 8 7\nf 1 2 4 3\nf 5 7 8 6\nf 1 3 7 5\nf 2 6 8 4\n");
};

TEST_F(AuralizeScene, HearsASourceThatComesNearerAtAHigherFrequency) {
    const RunResult result = play({"--path-of", way(), "--order", "0", "--no-air-absorption"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("; 1 paths at 11 instants"), std::string::npos) << result.out;
    const io::Sound wet = io::read_sound(path("wet.wav"));
    EXPECT_EQ(wet.sample_rate, kSampleRate);
    EXPECT_NEAR(upward_crossings(wet, 4000, 8000), 250, 1);  // 1000 Hz
}

TEST_F(AuralizeScene, GivesTheSameBytesForAnyThreads) {
    const std::vector<std::string> options = {
        "--path-of", way(), "--order", "1", "--format", "ambisonic:1"};
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
    both.insert(both.end(), {"--from", "car", "--mix", tone("bell.wav", 0.5), "bell"});
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
    fails({dry_}, 2, "--scene takes the place of");
    fails({"--step", "0"}, 2, "--step");
    EXPECT_TRUE(failed_with(
        run_earshot({"auralize", dry_, "-o", path("wet.wav")}), 2, "RESPONSE: is missing"));
    EXPECT_TRUE(failed_with(play_of(tone("two.wav", 0.1, 2), {}),
                            1,
                            "two.wav: has 2 channels; a source plays a mono recording"));
}

}  // namespace
}  // namespace earshot::test
