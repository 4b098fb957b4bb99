// SPDX-License-Identifier: MIT
// Scenes that move, played by the engine into a file.
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include "moving_source.h"
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

class Play : public MovingSource {
protected:
    RunResult play(const std::vector<std::string>& more) const {
        return MovingSource::play({"play", street_, "--sample-rate", "16000"}, more);
    }

    const std::string dry_ = tone("dry.wav", 1.0);

private:
    const std::string street_ = write(
        "street.obj", "v -500 0 -500\nv 500 0 -500\nv 500 0 500\nv -500 0 500\nf 1 3 2\nf 1 4 3\n");
};

TEST_F(Play, HearsASourceThatComesNearerAtAHigherFrequency) {
    const RunResult result = play({"--sound",
                                   dry_,
                                   "--path-of",
                                   way(),
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
    EXPECT_EQ(wet.sample_rate, kSampleRate);
    ASSERT_EQ(wet.samples.size(), 16000U);
    EXPECT_NEAR(upward_crossings(wet, 8000, 12000), 250, 1);  // 1000 Hz
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
                        "car=" + dry_,
                        "--path-of",
                        way(),
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
    fails({"--sound", "cart=" + dry_}, 1, "did you mean car?");
    fails({"--sound", path("missing.wav")}, 1, "missing.wav");
    fails({"--sound", dry_, "--sound", dry_}, 1, "two recordings");
    fails({"--sound", tone("two.wav", 0.1, 2)},
          1,
          "two.wav: has 2 channels; a source plays a mono recording");
    fails({"--sound", tone("empty.wav", 0.0)}, 1, "empty.wav: holds no samples");
    fails({"--sound", dry_, "--block", "300"}, 2, "--block");
    fails({"--sound", dry_, "--to", "eye"}, 1, "street.obj has no such listener");
    EXPECT_TRUE(failed_with(run_earshot({"play"}), 2, "SCENE: is missing"));
}

}  // namespace
}  // namespace earshot::test
