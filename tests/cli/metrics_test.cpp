// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include <cmath>
#include <filesystem>
#include <fstream>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Metrics : public testing::Test {
protected:
    Metrics() { fs::create_directories(folder_); }
    ~Metrics() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    /// Decays of 60 dB in these times, a channel each, over steady noise 60 dB below their start.
    std::string write_decays(const std::vector<double>& times) const {
        io::Sound sound{.channels = static_cast<int>(times.size()), .samples = {}};
        for (std::uint64_t n = 0; n < 96000; ++n) {
            for (std::uint64_t channel = 0; channel < times.size(); ++channel) {
                const double t = static_cast<double>(n) / sound.sample_rate;
                const double decay = std::exp(-6.907755 * t / times[channel]);
                sound.samples.push_back(decay * (random(1, channel, n) - 0.5) +
                                        1e-3 * (random(2, channel, n) - 0.5));
            }
        }
        const fs::path file = folder_ / "decays.wav";
        io::write_whole_file(file, io::encode_wav(sound));
        return file.string();
    }

    const fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("earshot_metrics_" +
         std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(Metrics, OfEveryChannelAsJson) {
    const RunResult result = run_earshot({"metrics", write_decays({0.4, 0.9}), "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["version"], 2);
    EXPECT_EQ(json["file"], "decays.wav");
    EXPECT_EQ(json["bands_hz"].size(), 10U);
    ASSERT_EQ(json["channels"].size(), 2U);
    EXPECT_NEAR(json["channels"][0]["t20"][5].get<double>(), 0.4, 0.03);
    EXPECT_NEAR(json["channels"][1]["t20"][5].get<double>(), 0.9, 0.06);
    EXPECT_NEAR(json["channels"][1]["sti"].get<double>(), 0.61, 0.03);
    const Json& channel = json["channels"][1];
    EXPECT_EQ(channel["channel"], 2);
    EXPECT_EQ(channel["sti_letter"], channel["sti"] >= 0.6 ? "D" : "E");
    EXPECT_NEAR(channel["single"]["t20_mid"].get<double>(),
                0.5 * (channel["t20"][4].get<double>() + channel["t20"][5].get<double>()),
                1e-12);
    EXPECT_FALSE(json.contains("speech_level"));
}

TEST_F(Metrics, OfSpeechInNoiseDependOnTheLevelAtTheListener) {
    const std::string file = write_decays({0.4});
    const auto index = [&](std::vector<std::string> extra) {
        std::vector<std::string> arguments = {"metrics", file, "--json"};
        arguments.insert(arguments.end(), extra.begin(), extra.end());
        const RunResult result = run_earshot(arguments);
        EXPECT_EQ(result.status, 0) << result.err;
        const Json json = Json::parse(result.out);
        EXPECT_EQ(json.contains("noise"), !extra.empty());
        return json["channels"][0]["sti"].get<double>();
    };
    const double quiet = index({});
    const double in_noise = index({"--noise", "NC-50"});
    EXPECT_LT(in_noise, quiet - 0.1);
    EXPECT_GT(index({"--noise", "NC-50", "--speech-level", "raised"}), in_noise + 0.05);
    // A talker 1 m from whom a sample is 1 brings the gain of the response along.
    EXPECT_NE(index({"--noise", "NC-50", "--calibrated"}), in_noise);
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--noise", "NC"}), 2, "--noise"));
}

TEST_F(Metrics, NotesOfOneReasonAreOneLine) {
    const fs::path file = folder_ / "brief.wav";
    std::vector<double> samples(3000, 0.0);
    samples[1000] = 1.0;
    io::write_whole_file(file, io::encode_wav({.samples = samples}));
    const RunResult result = run_earshot({"metrics", file.string(), "--noise-free"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("c50, d50: the response ends within 50 ms"), std::string::npos)
        << result.out;
    EXPECT_NE(result.out.find("c80, ts, g: the response ends within 80 ms"), std::string::npos);
}

TEST_F(Metrics, OfOneChannelAsATable) {
    const std::string file = write_decays({0.4, 0.9});
    const RunResult result = run_earshot({"metrics", file, "--channel", "2"});
    ASSERT_EQ(result.status, 0) << result.err;
    for (const char* label : {"channel 2", "EDT s", "T30 s", "C80 dB", "STI", "16000"}) {
        EXPECT_NE(result.out.find(label), std::string::npos) << label;
    }
    EXPECT_EQ(result.out.find("channel 1"), std::string::npos);
    const RunResult raw = run_earshot({"metrics", file, "--channel", "2", "--noise-free"});
    EXPECT_NE(raw.out, result.out);
}

TEST_F(Metrics, RefusesWhatItCannotRead) {
    EXPECT_TRUE(failed_with(run_earshot({"metrics"}), 2, "FILE"));
    EXPECT_TRUE(failed_with(run_earshot({"metrics", "missing.wav"}), 1, "missing.wav"));
    const fs::path text = folder_ / "text.wav";
    std::ofstream(text) << "no sound";
    EXPECT_TRUE(failed_with(run_earshot({"metrics", text.string()}), 1, "text.wav"));
    const std::string file = write_decays({0.3});
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--channel", "2"}), 1, "1 channels"));
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--bands", "half"}), 2, "--bands"));
}

TEST_F(Metrics, OfSilenceAreEmptyWithANote) {
    const fs::path file = folder_ / "silence.wav";
    io::write_whole_file(file, io::encode_wav({.samples = std::vector<double>(4800, 0.0)}));
    const RunResult result = run_earshot({"metrics", file.string(), "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(result.out);
    EXPECT_TRUE(json["channels"][0]["sti"].is_null());
    EXPECT_EQ(json["channels"][0]["notes"][0]["metric"], "all");
    EXPECT_EQ(json["channels"][0]["notes"][0]["text"], "the response is silent");
}

}  // namespace
}  // namespace earshot::test
