// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Metrics : public testing::Test {
protected:
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
        const fs::path file = folder_.path() / "decays.wav";
        io::write_whole_file(file, io::encode_wav(sound));
        return file.string();
    }

    const TemporaryFolder folder_;
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
    const fs::path file = folder_.path() / "brief.wav";
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
    const fs::path text = folder_.path() / "text.wav";
    std::ofstream(text) << "no sound";
    EXPECT_TRUE(failed_with(run_earshot({"metrics", text.string()}), 1, "text.wav"));
    const std::string file = write_decays({0.3});
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--channel", "2"}), 1, "1 channels"));
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--bands", "half"}), 2, "--bands"));
}

TEST_F(Metrics, OfSilenceAreEmptyWithANote) {
    const fs::path file = folder_.path() / "silence.wav";
    io::write_whole_file(file, io::encode_wav({.samples = std::vector<double>(4800, 0.0)}));
    const RunResult result = run_earshot({"metrics", file.string(), "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(result.out);
    EXPECT_TRUE(json["channels"][0]["sti"].is_null());
    EXPECT_EQ(json["channels"][0]["notes"][0]["metric"], "all");
    EXPECT_EQ(json["channels"][0]["notes"][0]["text"], "the response is silent");
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

// Fields up to the first quoted one.
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line.substr(0, line.find('"')));
    for (std::string field; std::getline(stream, field, ',');) {
        fields.push_back(field);
    }
    return fields;
}

TEST_F(Metrics, OfSeveralFilesAreATableWithARowPerBand) {
    const std::string file = write_decays({0.4, 0.9});
    const std::string other = (folder_.path() / "a, b.wav").string();
    fs::copy_file(file, other);
    const std::string table = (folder_.path() / "t.csv").string();
    const RunResult result = run_earshot({"metrics", file, other, "-o", table, "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json json = Json::parse(result.out);
    ASSERT_EQ(json["files"].size(), 2U);
    EXPECT_EQ(json["files"][1]["file"], "a, b.wav");

    const auto lines = lines_of(io::read_whole_file(table));
    ASSERT_EQ(lines.size(), 1U + 2 * 2 * 10);
    const auto columns = fields_of(lines[0]);
    const auto column = [&](const std::string& name) {
        return std::size_t(std::find(columns.begin(), columns.end(), name) - columns.begin());
    };
    const auto row = fields_of(lines[1 + 10 + 5]);  // second channel, 1 kHz
    EXPECT_EQ(row[column("file")], "decays.wav");
    EXPECT_EQ(row[column("channel")], "2");
    EXPECT_EQ(row[column("band_hz")], "1000.0");
    const Json& channel = json["files"][0]["channels"][1];
    for (const char* key :
         {"edt", "t20", "c50", "c80", "d50", "ts", "noise_level", "peak_to_noise"}) {
        EXPECT_EQ(std::stod(row[column(key)]), channel[key][5].get<double>()) << key;
    }
    EXPECT_EQ(row[column("g")], "");
    EXPECT_EQ(std::stod(row[column("sti")]), channel["sti"].get<double>());
    EXPECT_EQ(lines[1 + 20].substr(0, 14), "\"a, b.wav\",1,3");

    const std::string again = (folder_.path() / "t.json").string();
    EXPECT_EQ(run_earshot({"metrics", file, other, "-o", again}).out,
              again + ": metrics of 2 files\n");
    EXPECT_EQ(io::read_whole_file(again), result.out);
    EXPECT_TRUE(
        failed_with(run_earshot({"metrics", file, "-o", (folder_.path() / "t.xls").string()}),
                    1,
                    "use .csv or .json"));
}

TEST_F(Metrics, TheOnsetIsToldAndMayBeGiven) {
    const std::string file = write_decays({0.4});
    const auto onset_and_c80 = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"metrics", file, "--json"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Json channel = Json::parse(run_earshot(arguments).out)["channels"][0];
        return std::pair(channel["onset"].get<double>(), channel["c80"][6].get<double>());
    };
    const auto found = onset_and_c80({});
    EXPECT_LT(found.first, 0.001);
    // The rest of an exponential decay decays alike.
    const auto given = onset_and_c80({"--onset", "0.05"});
    EXPECT_EQ(given.first, 0.05);
    EXPECT_NEAR(given.second, found.second, 2.0);
    EXPECT_EQ(onset_and_c80({"--onset", "0.05", "--noise-free"}).first, 0.05);
    EXPECT_TRUE(
        failed_with(run_earshot({"metrics", file, "--onset", "2"}), 1, "give an --onset within"));
    EXPECT_TRUE(failed_with(run_earshot({"metrics", file, "--onset", "-1"}), 2, "--onset"));
}

TEST_F(Metrics, StrengthNeedsAReference) {
    const std::string file = write_decays({0.4});
    const auto strength = [&](const std::vector<std::string>& options) {
        std::vector<std::string> arguments = {"metrics", file, "--json"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const RunResult result = run_earshot(arguments);
        return result.status == 0 ? Json::parse(result.out)["channels"][0]["g"][6] : Json();
    };
    EXPECT_TRUE(strength({}).is_null());
    const double unit = strength({"--reference", "0"}).get<double>();
    EXPECT_EQ(strength({"--calibrated"}).get<double>(), unit);
    EXPECT_NEAR(strength({"--reference", "-6.5"}).get<double>(), unit + 6.5, 1e-9);
    io::Sound free_field{.samples = std::vector<double>(24000, 0.0)};
    free_field.samples[3000] = 0.5;
    for (std::size_t n = 0; n < free_field.samples.size(); ++n) {
        free_field.samples[n] += 1e-5 * (random(3, 0, n) - 0.5);
    }
    const std::string reference = (folder_.path() / "free.wav").string();
    io::write_whole_file(reference, io::encode_wav(free_field));
    // 0.5 at 2 m is 1 at 1 m.
    EXPECT_NEAR(strength({"--reference", reference, "--reference-distance", "2"}).get<double>(),
                unit,
                0.02);
    EXPECT_NEAR(strength({"--reference", reference}).get<double>(), unit - 13.98, 0.02);
    EXPECT_TRUE(failed_with(
        run_earshot({"metrics", file, "--reference-distance", "2"}), 2, "goes with a recording"));
    EXPECT_TRUE(failed_with(
        run_earshot({"metrics", file, "--reference", "3", "--calibrated"}), 2, "give one of them"));
}

TEST_F(Metrics, ClippingIsAWarning) {
    io::Sound sound = io::read_sound(write_decays({0.4}));
    for (double& sample : sound.samples) {
        sample = std::clamp(sample, -0.1, 0.1);
    }
    const std::string file = (folder_.path() / "clipped.wav").string();
    io::write_whole_file(file, io::encode_wav(sound));
    const RunResult result = run_earshot({"metrics", file});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.err.find("earshot: warning: " + file + ": "), std::string::npos);
    EXPECT_NE(result.err.find("samples are clipped"), std::string::npos) << result.err;
    EXPECT_EQ(run_earshot({"metrics", file, "--quiet"}).err, "");
}

TEST_F(Metrics, OfTheStageAndOfTheLateralSound) {
    const std::string file = write_decays({0.4, 0.4, 0.4, 0.4});
    const Json plain = Json::parse(run_earshot({"metrics", file, "--json"}).out);
    EXPECT_FALSE(plain["channels"][0].contains("st_early"));
    EXPECT_FALSE(plain.contains("lj"));
    const Json json = Json::parse(run_earshot({"metrics",
                                               file,
                                               "--json",
                                               "--support",
                                               "--listening",
                                               "ambisonic",
                                               "--reference",
                                               "0"})
                                      .out);
    // Of an exponential decay: e^(-a 20) - e^(-a 100) over 1 - e^(-a 10), a = 13.8 / 400 ms.
    const auto left = [](double ms) { return std::exp(-13.8155 / 400.0 * ms); };
    const double st_early = 10.0 * std::log10((left(20.0) - left(100.0)) / (1.0 - left(10.0)));
    const double st_late = 10.0 * std::log10(left(100.0) / (1.0 - left(10.0)));
    const Json& single = json["channels"][0]["single"];
    EXPECT_NEAR(single["st_early_mean"].get<double>(), st_early, 1.0);
    EXPECT_NEAR(single["st_late_mean"].get<double>(), st_late, 1.0);
    // The second channel's energy after 80 ms, from its G and C80.
    const double g = json["channels"][1]["g"][6].get<double>();
    const double c80 = json["channels"][1]["c80"][6].get<double>();
    EXPECT_NEAR(
        json["lj"][6].get<double>(), g - 10.0 * std::log10(1.0 + std::pow(10.0, c80 / 10.0)), 0.1);
    EXPECT_TRUE(json["lj_mean"].is_number());
}

}  // namespace
}  // namespace earshot::test
