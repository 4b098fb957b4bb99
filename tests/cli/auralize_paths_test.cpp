// SPDX-License-Identifier: MIT
// Recordings played over the paths that `earshot ir --frames` has written.
#include "earshot/geometry/types.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "moving_source.h"
#include "run_earshot.h"
#include "support/gltf_builder.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace earshot::test {
namespace {

using geometry::Vec3;
using Json = nlohmann::json;

constexpr double kRate = 48000.0;
constexpr double kFrequency = 1000.0;
constexpr double kSpeed = 10.0;  // metres per second
constexpr double kSpeedOfSound = 343.2;
constexpr double kReflection = 0.9;  // of pressure, at every wall
const Vec3 kSize(40.0, 12.0, 30.0);
const Vec3 kListener(20.0, 2.0, 10.0);

/// Passes the listener at 3 m, 0.5 s after the begin.
Vec3 source_at(double t) {
    return {20.0 + kSpeed * (t - 0.5), 2.0, 13.0};
}

/// A box in which a source passes a listener.
std::string passing_source() {
    GltfBuilder builder;
    std::vector<float> corners;
    for (int i = 0; i < 8; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            corners.push_back((i >> axis & 1) != 0 ? static_cast<float>(kSize[axis]) : 0.0F);
        }
    }
    const int mesh =
        builder.add_mesh(builder.add_accessor("VEC3", corners),
                         builder.add_accessor<std::uint16_t>(
                             "SCALAR", {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                                        2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3}));
    builder.json["materials"] = {
        {{"name", "wall"},
         {"extras",
          {{"acoustics",
            {{"absorption", 1.0 - kReflection * kReflection}, {"scattering", 0.0}}}}}}};
    builder.primitive(mesh)["material"] = 0;
    const auto emitter = [](const char* name, const char* role, const Vec3& at) -> Json {
        return {{"name", name},
                {"translation", {at.x, at.y, at.z}},
                {"extras", {{"acoustics", {{"role", role}}}}}};
    };
    builder.add_node({{"name", "box"}, {"mesh", mesh}});
    const int car = builder.add_node(emitter("car", "source", source_at(0.0)));
    Json ear = emitter("ear", "listener", kListener);
    const double half = std::sqrt(0.5);  // a quarter of a turn about +Y: looks along -X
    ear["rotation"] = {0.0, half, 0.0, half};
    builder.add_node(ear);
    builder.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
    std::vector<float> places;
    for (const double t : {0.0, 1.0}) {
        for (int axis = 0; axis < 3; ++axis) {
            places.push_back(static_cast<float>(source_at(t)[axis]));
        }
    }
    builder.add_animation(car,
                          "translation",
                          builder.add_accessor<float>("SCALAR", {0.0F, 1.0F}),
                          builder.add_accessor("VEC3", places),
                          "LINEAR");
    return builder.glb();
}

/// Pressure, and its first-order channels (ACN: left, up, front) by the directions of the images.
using FirstOrder = std::array<double, 4>;

/// p(t) = s(t_e) / r(t_e) of all images up to an order, t_e by bisection of t = t_e + r(t_e) / c.
FirstOrder heard_of_images(double t, int order) {
    const auto along = [](double length, double x, int n) {
        return n * length + (n % 2 == 0 ? x : length - x);
    };
    FirstOrder sum{};
    for (int i = -order; i <= order; ++i) {
        for (int j = -order; j <= order; ++j) {
            for (int k = -order; k <= order; ++k) {
                const int reflections = std::abs(i) + std::abs(j) + std::abs(k);
                if (reflections > order) {
                    continue;
                }
                const auto way_at = [&](double at) {
                    const Vec3 s = source_at(at);
                    return Vec3(along(kSize.x, s.x, i),
                                along(kSize.y, s.y, j),
                                along(kSize.z, s.z, k)) -
                           kListener;
                };
                const auto distance = [&](double at) { return glm::length(way_at(at)); };
                double low = t - 0.5, high = t;
                for (int step = 0; step < 60; ++step) {
                    const double middle = 0.5 * (low + high);
                    (middle + distance(middle) / kSpeedOfSound < t ? low : high) = middle;
                }
                const double pressure = std::pow(kReflection, reflections) / distance(low) *
                                        std::sin(2.0 * std::numbers::pi * kFrequency * low);
                const Vec3 towards = glm::normalize(way_at(low));
                const FirstOrder weights = {1.0, towards.z, towards.y, -towards.x};
                for (std::size_t channel = 0; channel < 4; ++channel) {
                    sum[channel] += pressure * weights[channel];
                }
            }
        }
    }
    return sum;
}

class AuralizePaths : public testing::Test {
protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    std::string tone(double seconds) const {
        const auto samples = static_cast<std::size_t>(seconds * kRate);
        return folder_.file("dry.wav", sine_wav(kRate, kFrequency, samples)).string();
    }
    /// Paths from 0 to 1 s.
    void find_paths(const std::string& step, int order) const {
        const RunResult result = run_earshot({"ir",
                                              folder_.file("box.glb", passing_source()).string(),
                                              "-o",
                                              path("out"),
                                              "--frames",
                                              "0:1:" + step,
                                              "--order",
                                              std::to_string(order),
                                              "--rays",
                                              "0",
                                              "--no-air-absorption"});
        ASSERT_EQ(result.status, 0) << result.err;
    }
    RunResult play(const std::vector<std::string>& more = {}, double seconds = 1.0) const {
        std::vector<std::string> arguments = {
            "auralize", tone(seconds), "--paths", path("out/paths.json"), "-o", path("wet.wav")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_earshot(arguments);
    }

    const TemporaryFolder folder_;
};

// What differs from the sum over images, in frequency, in level or as a line of its own, is 60 dB
// below it.
TEST_F(AuralizePaths, SoundsAsTheMovingImages) {
    for (const std::string step : {"0.01", "0.1"}) {
        for (const int order : {0, 1, 2}) {
            find_paths(step, order);
            const RunResult result = play();
            ASSERT_EQ(result.status, 0) << result.err;
            EXPECT_EQ(result.err, "");
            constexpr std::array<int, 3> kImages = {1, 7, 25};
            EXPECT_NE(
                result.out.find("; " + std::to_string(kImages[static_cast<std::size_t>(order)]) +
                                " paths at " + (step == "0.1" ? "11" : "101") + " instants"),
                std::string::npos)
                << result.out;
            const io::Sound wet = io::read_sound(path("wet.wav"));
            double difference = 0.0, energy = 0.0;
            for (std::size_t n = 19200; n < 47000; n += 7) {
                const double expected = heard_of_images(static_cast<double>(n) / kRate, order)[0];
                const double off = wet.samples[n] - expected;
                difference += off * off;
                energy += expected * expected;
            }
            const double level = 10.0 * std::log10(difference / energy);
            EXPECT_LT(level, -60.0) << "step " << step << ", order " << order;
            RecordProperty("difference_db_" + step.substr(2) + "_" + std::to_string(order),
                           std::to_string(level));
        }
    }
}

// The listener's turn is that of the file.
TEST_F(AuralizePaths, SoundsFromTheDirectionsOfTheMovingImages) {
    find_paths("0.1", 1);
    const RunResult result = play({"--format", "ambisonic:1"});
    ASSERT_EQ(result.status, 0) << result.err;
    const io::Sound wet = io::read_sound(path("wet.wav"));
    ASSERT_EQ(wet.channels, 4);
    FirstOrder difference{}, energy{};
    for (std::size_t n = 19200; n < 47000; n += 7) {
        const FirstOrder expected = heard_of_images(static_cast<double>(n) / kRate, 1);
        for (std::size_t channel = 0; channel < 4; ++channel) {
            const double off = wet.samples[4 * n + channel] - expected[channel];
            difference[channel] += off * off;
            energy[channel] += expected[channel] * expected[channel];
        }
    }
    for (std::size_t channel = 0; channel < 4; ++channel) {
        const double level = 10.0 * std::log10(difference[channel] / energy[channel]);
        EXPECT_LT(level, -60.0) << "channel " << channel;
        RecordProperty("difference_db_" + std::to_string(channel), std::to_string(level));
    }
}

TEST_F(AuralizePaths, SoundsAtTwoEarsAsInTheScene) {
    find_paths("0.1", 1);
    ASSERT_EQ(play({"--format", "binaural"}).status, 0);
    const io::Sound found = io::read_sound(path("wet.wav"));
    const RunResult scene = run_earshot({"auralize",
                                         path("dry.wav"),
                                         "--scene",
                                         path("box.glb"),
                                         "--format",
                                         "binaural",
                                         "--step",
                                         "0.1",
                                         "--order",
                                         "1",
                                         "--rays",
                                         "0",
                                         "--no-air-absorption",
                                         "-o",
                                         path("scene.wav")});
    ASSERT_EQ(scene.status, 0) << scene.err;
    const io::Sound expected = io::read_sound(path("scene.wav"));
    ASSERT_EQ(found.channels, 2);
    ASSERT_EQ(found.samples.size(), expected.samples.size());
    double difference = 0.0, energy = 0.0;
    for (std::size_t i = 0; i < found.samples.size(); ++i) {
        const double off = found.samples[i] - expected.samples[i];
        difference += off * off;
        energy += expected.samples[i] * expected.samples[i];
    }
    EXPECT_LT(10.0 * std::log10(difference / energy), -60.0);
}

TEST_F(AuralizePaths, GivesTheSameBytesForAnyThreads) {
    find_paths("0.1", 1);
    const auto with_threads = [&](const std::string& threads) {
        EXPECT_EQ(play({"--threads", threads}).status, 0);
        return io::read_whole_file(path("wet.wav"));
    };
    EXPECT_EQ(with_threads("1"), with_threads("3"));
}

TEST_F(AuralizePaths, StaysAfterTheLastInstant) {
    find_paths("0.5", 0);
    const RunResult result = play({"--from", "car", "--to", "ear"}, 1.3);
    ASSERT_EQ(result.status, 0);
    EXPECT_NE(result.err.find("goes on after the last instant"), std::string::npos) << result.err;
    const io::Sound wet = io::read_sound(path("wet.wav"));
    const double distance = glm::distance(source_at(1.0), kListener);
    for (std::size_t n = 52000; n < 62000; n += 7) {
        const double emission = static_cast<double>(n) / kRate - distance / kSpeedOfSound;
        const double expected = std::sin(2.0 * std::numbers::pi * kFrequency * emission) / distance;
        ASSERT_NEAR(wet.samples[n], expected, 1e-4) << n;
    }
}

TEST_F(AuralizePaths, SaysWhatIsWrongWithTheCommandLine) {
    find_paths("0.5", 0);
    const auto fails = [&](std::vector<std::string> more, int status, const std::string& message) {
        EXPECT_TRUE(failed_with(play(more), status, message));
    };
    fails({"--from", "cat"}, 1, "did you mean car?");
    fails({"--to", "nobody"}, 1, "has no such listener");
    fails({"--mix", path("dry.wav"), "bell"}, 1, "has no such source");
    fails({"--scene", path("box.glb")}, 2, "--scene");
    fails({"--order", "2"}, 2, "--order");
    fails({"--format", "ears"}, 2, "is not one of mono, binaural, ambisonic:N");
    fails({"--format", "binaural", "--hrtf", path("none.sofa")}, 1, "none.sofa");
    fails({path("out/car__ear.wav")}, 2, "--paths takes the place of");
    fails({"--paths", path("none.json")}, 2, "--paths");
}

TEST_F(AuralizePaths, RefusesWhatIsNotPathsOfFrames) {
    find_paths("0.5", 1);
    const std::string text = io::read_whole_file(path("out/paths.json"));
    const auto fails = [&](const std::string& content, const std::string& message) {
        io::write_whole_file(path("out/paths.json"), content);
        EXPECT_TRUE(failed_with(play(), 1, message));
    };
    const auto fails_with = [&](const std::function<void(Json&)>& change,
                                const std::string& message) {
        Json json = Json::parse(text);
        change(json);
        fails(json.dump(), message);
    };
    fails("", "is not JSON");
    fails(text.substr(0, text.size() / 2), "is not JSON");
    fails("[]", "is not a JSON object");
    fails("{}", "bands_hz");
    fails(std::string(1000, '['), "nested deeper");
    for (const char* key : {"bands_hz", "speed_of_sound"}) {
        fails_with([&](Json& json) { json.erase(key); }, key);
        fails_with([&](Json& json) { json[key] = "many"; }, "does not hold what it should");
    }
    for (const char* key : {"source", "listener", "time", "paths"}) {
        fails_with([&](Json& json) { json["pairs"][1].erase(key); }, key);
        fails_with([&](Json& json) { json["pairs"][1][key] = {{"a", 1}}; }, "paths.json: ");
    }
    for (const char* key : {"kind", "points", "triangles", "pressure"}) {
        fails_with([&](Json& json) { json["pairs"][1]["paths"][2].erase(key); }, key);
        fails_with([&](Json& json) { json["pairs"][1]["paths"][2][key] = 1.5; }, "paths.json: ");
        fails_with([&](Json& json) { json["pairs"][1]["paths"][2][key] = nullptr; },
                   "paths.json: ");
    }
    const auto fails_in_path = [&](const std::function<void(Json&)>& change,
                                   const std::string& message) {
        fails_with([&](Json& json) { change(json["pairs"][1]["paths"][2]); }, message);
    };
    fails_with([](Json& json) { json["pairs"] = Json::array(); }, "has no pair");
    fails_with([](Json& json) { json["pairs"][1].erase("listener_up"); }, "listener_up");
    fails_with([](Json& json) { json["pairs"][1]["listener_up"] = {0, 2, 0}; }, "unit vectors");
    fails_with([](Json& json) { json["pairs"][1]["listener_up"] = {-1, 0, 0}; }, "right angles");
    fails_with(
        [](Json& json) {
            Json& paths = json["pairs"][1]["paths"];
            paths[2]["triangles"] = paths[1]["triangles"];
        },
        "not those of reflections");
    fails_with(
        [](Json& json) {
            json["pairs"].erase(1);
            json["pairs"].erase(1);
        },
        "has paths at one instant alone");
    fails_with([](Json& json) { json["pairs"][1]["time"] = json["pairs"][0]["time"]; },
               "has a pair twice");
    fails_with([](Json& json) { json["pairs"][1]["time"] = 1e300; }, "out of range");
    fails_with([](Json& json) { json["pairs"][1]["time"] = 1e-9; }, "ascend by a microsecond");
    fails_with([](Json& json) { json["pairs"][1]["time"] = 1e-4; }, "0.9 of the speed of sound");
    fails_with([](Json& json) { json["speed_of_sound"] = 1e-3; }, "out of range");
    fails_with([](Json& json) { json["bands_hz"][0] = 30; }, "neither octaves nor third octaves");
    fails_with(
        [](Json& json) {
            for (Json& pair : json["pairs"]) {
                pair["paths"] = Json::array();
            }
        },
        "has no path of this source and listener");
    fails_in_path([](Json& json) { json["kind"] = "heard"; }, "unknown kind");
    fails_in_path([](Json& json) { json["kind"] = "diffracted"; }, "edges");
    fails_in_path([](Json& json) { json["triangles"] = {-1}; }, "where an index should be");
    fails_in_path([](Json& json) { json["triangles"] = Json::array(); }, "a point per triangle");
    fails_in_path([](Json& json) { json["points"][1] = {1, 2}; }, "without three coordinates");
    fails_in_path([](Json& json) { json["points"][1] = {1e6, 2, 3}; }, "100 km");
    fails_in_path([](Json& json) { json["points"][1] = {1e300, 2, 3}; }, "out of range");
    fails_in_path([](Json& json) { json["points"][0] = {30, 2, 3}; }, "two places at a time");
    fails_in_path([](Json& json) { json["points"][1] = json["points"][0]; }, "paths.json: ");
    fails_in_path([](Json& json) { json["pressure"].erase(0); }, "other bands");
    fails_in_path([](Json& json) { json["pressure"][3] = -0.1; }, "changes sign");
}

}  // namespace
}  // namespace earshot::test
