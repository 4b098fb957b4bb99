// SPDX-License-Identifier: MIT

#include <nlohmann/json.hpp>

#include "run_earshot.h"
#include "support/read_file.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kScenes = test::source_file("scenes/").string();
const std::string kBox = test::source_file("scenes/shoebox.gltf").string();

/// A folder of its own for each test, removed at the end.
class Ir : public testing::Test {
protected:
    std::string out() const { return (folder_.path() / "out").string(); }
    /// `earshot ir SCENE -o OUT FIXED MORE`.
    RunResult ir(const std::string& scene,
                 const std::vector<std::string>& fixed = {},
                 const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {"ir", scene, "-o", out()};
        arguments.insert(arguments.end(), fixed.begin(), fixed.end());
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }
    Json json_of(const std::string& name) const {
        return Json::parse(read_file(folder_.path() / "out" / name));
    }

    const TemporaryFolder folder_;
};

TEST_F(Ir, WritesResponsesPathsAndMetrics) {
    const RunResult result = ir(kBox, {"--order", "2", "--rays", "20000", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");

    const Json paths = json_of("paths.json");
    EXPECT_EQ(paths["version"], 1);
    EXPECT_EQ(paths["scene"], "shoebox.gltf");
    EXPECT_NEAR(paths["speed_of_sound"].get<double>(), 343.2, 1e-9);
    ASSERT_EQ(paths["bands_hz"].size(), 10U);
    ASSERT_EQ(paths["pairs"].size(), 1U);
    const Json& pair = paths["pairs"][0];
    ASSERT_EQ(pair["paths"].size(), 25U);  // 1 + 6 + 18 images
    double last_delay = 0.0;
    for (const Json& path : pair["paths"]) {
        const auto order = path["order"].get<std::size_t>();
        EXPECT_EQ(path["kind"], order == 0 ? "direct" : "specular");
        EXPECT_EQ(path["points"].size(), order + 2);
        EXPECT_EQ(path["triangles"].size(), order);
        EXPECT_EQ(path["materials"].size(), order);
        EXPECT_EQ(path["pressure"].size(), 10U);
        EXPECT_NEAR(path["delay"].get<double>() * 343.2, path["length"].get<double>(), 1e-9);
        EXPECT_GE(path["delay"].get<double>(), last_delay);
        last_delay = path["delay"].get<double>();
    }
    const Json metrics = json_of("metrics.json");
    EXPECT_EQ(metrics["version"], 2);
    EXPECT_NEAR(metrics["room"]["volume"].get<double>(), 168.0, 1.0);
    EXPECT_NEAR(metrics["room"]["surface"].get<double>(), 194.0, 1.0);
    const Json& of_pair = metrics["pairs"][0];
    for (const char* name : {"edt", "t20", "t30", "c50", "c80", "d50", "ts", "g"}) {
        EXPECT_EQ(of_pair[name].size(), 10U) << name;
        EXPECT_EQ(of_pair["response"][name].size(), 10U) << name;
        EXPECT_EQ(of_pair["standard_error"][name].size(), 10U) << name;
        EXPECT_NEAR(of_pair["single"][std::string(name) + "_mid"].get<double>(),
                    0.5 * (of_pair[name][4].get<double>() + of_pair[name][5].get<double>()),
                    1e-12)
            << name;
    }
    EXPECT_GT(of_pair["standard_error"]["t30"][5].get<double>(), 0.0);
    EXPECT_GT(of_pair["standard_error"]["sti"].get<double>(), 0.0);
    const std::string wav =
        pair["source"].get<std::string>() + "__" + pair["listener"].get<std::string>() + ".wav";
    EXPECT_EQ(read_file(folder_.path() / "out" / wav).substr(0, 4), "RIFF");
}

TEST_F(Ir, TheDirectSoundArrivesWhenAndAsLoudAsItShould) {
    // 10 m apart in the open: a triangle far away makes it a scene.
    const fs::path scene = folder_.path() / "field.obj";
    std::ofstream(scene) << "v 900 900 900\nv 901 900 900\nv 900 901 900\nf 1 2 3\n";
    const RunResult result = ir(scene.string(),
                                {"--source",
                                 "0,0,0",
                                 "--listener",
                                 "far=10,0,0",
                                 "--rays",
                                 "1000",
                                 "--no-air-absorption",
                                 "--sample-rate",
                                 "34320",
                                 "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json path = json_of("paths.json")["pairs"][0]["paths"][0];
    EXPECT_EQ(path["length"], 10.0);
    for (const Json& pressure : path["pressure"]) {
        EXPECT_DOUBLE_EQ(pressure.get<double>(), 0.1);
    }
    EXPECT_EQ(path["departure"], (Json{1.0, 0.0, 0.0}));
    // At 34320 Hz the delay is 1000 samples exactly; the header of a float WAV ends with "data".
    const std::string wav = read_file(folder_.path() / "out" / "source1__far.wav");
    const std::size_t data = wav.find("data") + 8;
    const auto sample = [&](std::size_t i) {
        float value = 0.0F;
        std::memcpy(&value, wav.data() + data + 4 * i, 4);
        return value;
    };
    EXPECT_NEAR(sample(1000), 0.1, 1e-4);
    EXPECT_NEAR(sample(900), 0.0, 1e-6);
    const Json summary = Json::parse(result.out);
    EXPECT_EQ(summary["paths_per_order"], (Json{1, 0, 0, 0, 0}));
    EXPECT_EQ(summary["files"].size(), 3U);
}

TEST_F(Ir, SilenceIsAnAnswer) {
    const fs::path scene = folder_.path() / "sealed.obj";
    std::ofstream(scene)
        << "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
           "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 4 8 5\n";
    const RunResult result =
        ir(scene.string(), {"--source", "5,1,1", "--listener", "in=1,1.1,0.9", "--rays", "1000"});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.err.find("earshot: warning: source1__in: no path"), std::string::npos)
        << result.err;
    EXPECT_TRUE(json_of("paths.json")["pairs"][0]["paths"].empty());
    const Json metrics = json_of("metrics.json")["pairs"][0];
    EXPECT_TRUE(metrics["c80"][3].is_null());
    EXPECT_TRUE(metrics["response"]["c80"][3].is_null());
    EXPECT_EQ(metrics["notes"][0],
              Json({{"metric", "all"}, {"band_hz", nullptr}, {"text", "the response is silent"}}));
    const std::string wav = read_file(folder_.path() / "out" / "source1__in.wav");
    const std::string samples = wav.substr(wav.find("data") + 8);
    EXPECT_FALSE(samples.empty());
    EXPECT_EQ(samples.find_first_not_of('\0'), std::string::npos);
}

TEST_F(Ir, FramesMakeOneResponsePerInstant) {
    const RunResult result =
        ir(kScenes + "door.gltf",
           {"--order", "1", "--frames", "0:1:0.5", "--rays", "500", "--length", "0.5", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json paths = json_of("paths.json");
    const std::size_t listeners = paths["pairs"].size() / 3;
    ASSERT_GE(listeners, 1U);
    std::vector<double> times;
    for (std::size_t i = 0; i < paths["pairs"].size(); i += listeners) {
        times.push_back(paths["pairs"][i]["time"]);
    }
    EXPECT_EQ(times, (std::vector<double>{0.0, 0.5, 1.0}));
    std::size_t numbered = 0;
    for (const auto& entry : fs::directory_iterator(out())) {
        const std::string name = entry.path().filename().string();
        numbered += name.ends_with("__0000.wav") || name.ends_with("__0001.wav") ||
                            name.ends_with("__0002.wav")
                        ? 1
                        : 0;
    }
    EXPECT_EQ(numbered, 3 * listeners);

    // One instant alone gives the same as that instant of the sequence.
    ASSERT_EQ(ir(kScenes + "door.gltf", {"--order", "1", "--time", "0.5", "--rays", "0"}).status,
              0);
    EXPECT_EQ(json_of("paths.json")["pairs"][0], paths["pairs"][listeners]);
}

/// The samples per channel of a 32-bit float WAV.
std::vector<std::vector<double>> read_channels(const fs::path& file) {
    const std::string wav = read_file(file);
    std::uint16_t count = 0;
    std::memcpy(&count, wav.data() + 22, sizeof count);
    std::vector<std::vector<double>> channels(count);
    const std::size_t begin = wav.find("data") + 8;
    for (std::size_t n = 0; begin + (n + 1) * sizeof(float) <= wav.size(); ++n) {
        float sample = 0.0F;
        std::memcpy(&sample, wav.data() + begin + n * sizeof(float), sizeof sample);
        channels[n % count].push_back(sample);
    }
    return channels;
}

/// Sum of squares per channel.
std::vector<double> channel_energies(const fs::path& file) {
    std::vector<double> energies;
    for (const std::vector<double>& samples : read_channels(file)) {
        energies.push_back(
            std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0));
    }
    return energies;
}

TEST_F(Ir, TwoEarsHearWhereASourceIs) {
    const auto ears_looking_at = [&](const std::string& point) {
        const RunResult result = ir(kBox,
                                    {"--order",
                                     "0",
                                     "--rays",
                                     "0",
                                     "--source",
                                     "a=2,1.5,1",
                                     "--listener",
                                     "b=3,1.5,1",
                                     "--look-at",
                                     point,
                                     "--format",
                                     "binaural"});
        EXPECT_EQ(result.status, 0) << result.err;
        return channel_energies(folder_.path() / "out" / "a__b.wav");
    };
    // The source is at -x of the listener.
    const auto facing_minus_z = ears_looking_at("b=3,1.5,0.5");
    ASSERT_EQ(facing_minus_z.size(), 2U);
    EXPECT_GT(facing_minus_z[0], 4.0 * facing_minus_z[1]);
    const auto facing_plus_z = ears_looking_at("3,1.5,1.5");
    EXPECT_GT(facing_plus_z[1], 4.0 * facing_plus_z[0]);
    const Json metrics = json_of("metrics.json")["pairs"].back();
    EXPECT_EQ(metrics["iacc"].size(), 10U);
}

// --hrtf-raw leaves the delay of the measurement in: the loudspeaker was 1.4 m away, and of its 4
// ms the data still has 0.9 ms.
TEST_F(Ir, RemovesTheDelayAndTheLoudspeakerOfTheDefaultHrirsUnlessTheyAreRaw) {
    const auto ear = [&](std::vector<std::string> options) {
        const RunResult result = ir(kBox,
                                    {"--quiet",
                                     "--order",
                                     "0",
                                     "--rays",
                                     "0",
                                     "--no-air-absorption",
                                     "--source",
                                     "a=3,1.5,0.5",
                                     "--listener",
                                     "b=3,1.5,2.5",
                                     "--format",
                                     "binaural"},
                                    options);
        EXPECT_EQ(result.status, 0) << result.err;
        return read_channels(folder_.path() / "out" / "a__b.wav").at(0);
    };
    const auto onset = [](const std::vector<double>& samples) {
        double largest = 0.0;
        for (const double sample : samples) {
            largest = std::max(largest, std::abs(sample));
        }
        const auto first = std::find_if(samples.begin(), samples.end(), [&](double sample) {
            return std::abs(sample) > 0.1 * largest;
        });
        return static_cast<double>(first - samples.begin()) / 48.0;  // milliseconds
    };
    const auto sum = [](const std::vector<double>& samples) {  // the pressure at 0 Hz
        return std::accumulate(samples.begin(), samples.end(), 0.0);
    };
    const std::vector<double> equalised = ear({});
    const std::vector<double> raw = ear({"--hrtf-raw"});
    EXPECT_NEAR(onset(equalised), 2000.0 / 343.2, 0.1);
    EXPECT_NEAR(onset(raw) - onset(equalised), 0.9, 0.1);
    EXPECT_NEAR(sum(equalised), 0.5, 0.03);
    EXPECT_LT(std::abs(sum(raw)), 0.05);
}

TEST_F(Ir, AmbisonicChannelsAndSofaHoldTheLateSoundToo) {
    const RunResult result = ir(
        kBox,
        {"--order", "1", "--rays", "20000", "--format", "ambisonic:2", "--histograms", "--sofa"});
    ASSERT_EQ(result.status, 0) << result.err;
    const Json pair = json_of("metrics.json")["pairs"][0];
    const std::string name =
        pair["source"].get<std::string>() + "__" + pair["listener"].get<std::string>() + ".wav";
    const auto energies = channel_energies(folder_.path() / "out" / name);
    ASSERT_EQ(energies.size(), 9U);
    for (const double energy : energies) {
        EXPECT_GT(energy, 0.01 * energies[0]);
        EXPECT_LE(energy, energies[0]);
    }
    EXPECT_TRUE(pair["lf"][5].is_number());
    EXPECT_TRUE(pair["t30"][5].is_number());
    EXPECT_TRUE(pair["response"]["t30"][5].is_number());
    EXPECT_GT(pair["schroeder_hz"].get<double>(), 20.0);
    EXPECT_TRUE(fs::exists(folder_.path() / "out" / "responses.sofa"));
    const Json histogram = json_of("histograms.json")["pairs"][0];
    const auto energy = histogram["energy"][5].get<std::vector<double>>();
    const auto error = histogram["error"][5].get<std::vector<double>>();
    ASSERT_EQ(error.size(), energy.size());
    double all = 0.0, errors = 0.0;
    for (std::size_t n = 0; n < energy.size(); ++n) {
        all += energy[n];
        errors += error[n];
    }
    EXPECT_GT(errors, 0.0);
    EXPECT_LT(errors, all);
}

TEST_F(Ir, ACardioidIsSilentBehind) {
    const auto level_facing = [&](const std::string& point) {
        const RunResult result = ir(kBox,
                                    {"--order",
                                     "0",
                                     "--rays",
                                     "0",
                                     "--source",
                                     "a=2,1.5,1",
                                     "--listener",
                                     "b=3,1.5,1",
                                     "--directivity",
                                     "a=cardioid",
                                     "--aim-at",
                                     point});
        EXPECT_EQ(result.status, 0) << result.err;
        return json_of("paths.json")["pairs"].back()["paths"][0]["pressure"][5].get<double>();
    };
    const double in_front = level_facing("3,1.5,1");
    EXPECT_NEAR(in_front, 1.0, 0.01);
    EXPECT_NEAR(level_facing("2,1.5,2"), 0.5 * in_front, 1e-9);
    EXPECT_NEAR(level_facing("1,1.5,1"), 0.0, 1e-9);
}

TEST_F(Ir, ThirdOctavesGiveThirtyOneBands) {
    ASSERT_EQ(ir(kBox, {"--order", "0", "--bands", "third", "--rays", "2000", "--quiet"}).status,
              0);
    EXPECT_EQ(json_of("paths.json")["pairs"][0]["paths"][0]["pressure"].size(), 31U);
    const Json metrics = json_of("metrics.json")["pairs"][0];
    EXPECT_EQ(metrics["t30"].size(), 31U);
    EXPECT_TRUE(metrics["sti"].is_number());
}

TEST_F(Ir, LimitsLeaveOutWhatIsLongerOrFainter) {
    const auto paths_with = [&](std::vector<std::string> extra) {
        EXPECT_EQ(ir(kBox, {"--order", "3", "--rays", "0", "--quiet"}, extra).status, 0);
        return json_of("paths.json")["pairs"][0]["paths"];
    };
    const Json all = paths_with({});
    const auto loudest = [](const Json& path) {
        const auto pressure = path["pressure"].get<std::vector<double>>();
        return 20.0 * std::log10(*std::max_element(pressure.begin(), pressure.end()));
    };
    Json near = Json::array();
    Json loud = Json::array();
    for (const Json& path : all) {
        if (path["length"] <= 12.0) {
            near.push_back(path);
        }
        if (loudest(path) >= -25.0) {
            loud.push_back(path);
        }
    }
    ASSERT_LT(near.size(), all.size());
    ASSERT_LT(loud.size(), all.size());
    EXPECT_EQ(paths_with({"--max-length", "12"}), near);
    EXPECT_EQ(paths_with({"--min-level", "-25"}), loud);
}

TEST_F(Ir, TransmissionGoesThroughWallsThatLetSoundThrough) {
    const std::string file = (folder_.path() / "two_rooms.gltf").string();
    Json scene = Json::parse(read_file(kScenes + "coupled_rooms.gltf"));
    for (Json& material : scene["materials"]) {
        material["extras"]["acoustics"]["transmission"] = 0.01;
    }
    std::ofstream(file) << scene.dump();
    const auto kinds_with = [&](std::vector<std::string> extra) {
        EXPECT_EQ(ir(file, {"--order", "3", "--rays", "0", "--quiet"}, extra).status, 0);
        std::map<std::string, int> kinds;
        const Json paths = json_of("paths.json");
        for (const Json& pair : paths["pairs"]) {
            for (const Json& path : pair["paths"]) {
                ++kinds[path["kind"]];
                EXPECT_EQ(path["triangles"].size() + 2, path["points"].size());
            }
        }
        return kinds;
    };
    EXPECT_EQ(kinds_with({})["transmitted"], 0);
    EXPECT_GT(kinds_with({"--transmission"})["transmitted"], 3);
}

TEST_F(Ir, RaysAddTheDecayTheSameForAnyNumberOfThreads) {
    const auto files_with = [&](const std::string& threads) {
        EXPECT_EQ(
            ir(kBox, {"--order", "2", "--rays", "3000", "--threads", threads, "--quiet"}).status,
            0);
        std::string all;
        for (const auto& entry : fs::directory_iterator(out())) {
            all += read_file(entry.path());
        }
        return all;
    };
    const std::string one = files_with("1");
    const Json metrics = json_of("metrics.json");
    EXPECT_TRUE(metrics["pairs"][0]["t30"][5].is_number());
    EXPECT_TRUE(metrics["pairs"][0]["sti"].is_number());
    EXPECT_EQ(json_of("paths.json")["pairs"][0]["paths"].size(), 25U);
    EXPECT_EQ(files_with("2"), one);
}

TEST_F(Ir, TracesRaysUntilTheErrorIsSmallOrSaysSo) {
    // A box without scattering needs few; the errors are of late sound beyond order 1.
    const RunResult result = ir(kBox, {"--order", "1", "--rays-error", "5"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err.find("standard error"), std::string::npos) << result.err;
}

TEST_F(Ir, RefusesWrongOptionsWithStatusTwo) {
    const auto with = [&](std::vector<std::string> extra) { return ir(kBox, extra); };
    EXPECT_TRUE(failed_with(with({"--order", "-1"}), 2, "--order"));
    EXPECT_TRUE(failed_with(with({"--order", "3.5"}), 2, "--order"));
    EXPECT_TRUE(failed_with(with({"--max-length", "-1"}), 2, "--max-length"));
    EXPECT_TRUE(failed_with(with({"--min-level", "loud"}), 2, "--min-level"));
    EXPECT_TRUE(failed_with(with({"--rays", "-1"}), 2, "--rays"));
    EXPECT_TRUE(failed_with(with({"--rays", "many"}), 2, "neither auto nor"));
    EXPECT_TRUE(failed_with(with({"--rays-error", "0"}), 2, "--rays-error"));
    EXPECT_TRUE(failed_with(with({"--sample-rate", "0"}), 2, "--sample-rate"));
    EXPECT_TRUE(failed_with(with({"--format", "quadro"}), 2, "ambisonic:N"));
    EXPECT_TRUE(failed_with(with({"--format", "ambisonic:6"}), 2, "0 ... 5"));
    EXPECT_TRUE(failed_with(with({"--look-at", "here"}), 2, "[NAME=]X,Y,Z"));
    EXPECT_TRUE(failed_with(with({"--look-at", "nobody=1,2,3"}), 1, "nobody"));
    EXPECT_TRUE(failed_with(with({"--directivity", "heart"}), 1, "cardioid"));
    EXPECT_TRUE(failed_with(with({"--format", "binaural", "--hrtf", "no.sofa"}), 1, "no.sofa"));
    EXPECT_TRUE(failed_with(with({"--length", "-1"}), 2, "--length"));
    EXPECT_TRUE(failed_with(with({"--bands", "quarter"}), 2, "--bands"));
    EXPECT_TRUE(failed_with(with({"--mode", "guess"}), 2, "--mode"));
    EXPECT_TRUE(failed_with(with({"--resolution", "9999"}), 2, "--resolution"));
    EXPECT_TRUE(failed_with(with({"--source", "1,2"}), 2, "[NAME=]X,Y,Z"));
    EXPECT_TRUE(failed_with(with({"--listener", "1,2,nan"}), 2, "[NAME=]X,Y,Z"));
    EXPECT_TRUE(failed_with(with({"--frames", "1:0:0.1"}), 2, "A:B:STEP"));
    EXPECT_TRUE(failed_with(with({"--frames", "0:1:0"}), 2, "A:B:STEP"));
    EXPECT_TRUE(failed_with(with({"--time", "abc"}), 2, "--time"));
    EXPECT_TRUE(failed_with(with({"--time", "1", "--frames", "0:1:1"}), 2, "--"));
    EXPECT_TRUE(failed_with(with({"--simd", "avx1024"}), 2, "--simd"));
    EXPECT_TRUE(failed_with(with({"--odrer", "2"}), 2, "did you mean --order?"));
    EXPECT_TRUE(failed_with(run_earshot({"ir", "-o", out()}), 2, "SCENE"));
    EXPECT_TRUE(failed_with(run_earshot({"ir", kBox}), 2, "output"));
}

TEST_F(Ir, RefusesBadInputWithStatusOne) {
    EXPECT_TRUE(failed_with(ir("missing.gltf"), 1, "missing.gltf"));
    EXPECT_TRUE(failed_with(ir(folder_.path().string()), 1, folder_.path().string()));
    const fs::path plain = folder_.path() / "plain.obj";
    std::ofstream(plain) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_TRUE(failed_with(ir(plain.string()), 1, "no source"));
    EXPECT_TRUE(failed_with(ir(plain.string(), {"--source", "1,1,1"}), 1, "no listener"));
    const fs::path flat = folder_.path() / "flat.obj";
    std::ofstream(flat) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    EXPECT_TRUE(failed_with(
        ir(flat.string(), {"--source", "1,1,1", "--listener", "2,2,2"}), 1, "no triangle"));
    EXPECT_TRUE(failed_with(ir(kBox, {"--temperature", "900"}), 1, "900"));
    EXPECT_TRUE(failed_with(ir(kBox, {"--humidity", "120"}), 1, "120"));
    EXPECT_TRUE(failed_with(ir(kBox, {"--pressure", "0"}), 1, "0"));
    EXPECT_TRUE(failed_with(ir(kBox, {"--animation", "dance"}), 1, "dance"));
    EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Ir, LeavesNothingWhereItCannotWrite) {
    const fs::path file = folder_.path() / "file";
    std::ofstream(file) << "x";
    const RunResult result = run_earshot({"ir", kBox, "-o", file.string()});
    EXPECT_TRUE(failed_with(result, 1, file.string()));
    const RunResult below = run_earshot({"ir", kBox, "-o", (file / "below").string()});
    EXPECT_TRUE(failed_with(below, 1, "below"));
    EXPECT_EQ(read_file(file), "x");
}

TEST_F(Ir, AFileNameNeverLeavesTheFolder) {
    const RunResult result = ir(kBox,
                                {"--order",
                                 "0",
                                 "--rays",
                                 "0",
                                 "--quiet",
                                 "--source",
                                 "../../evil=1,1,1",
                                 "--source",
                                 "a/b=1,1.2,1"});
    ASSERT_EQ(result.status, 0) << result.err;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
        EXPECT_TRUE(entry.is_directory() || entry.path().parent_path() == folder_.path() / "out")
            << entry.path();
    }
}

}  // namespace
}  // namespace earshot::test
