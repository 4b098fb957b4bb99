// SPDX-License-Identifier: MIT
#include "earshot/propagation/path_frames.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/io/default_hrir_set.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "moving_part.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kStep = 0.05;
constexpr double kSeconds = 0.6;
constexpr double kRate = 16000.0;

Vec3 source_at(double t) {
    return {2.0 + 5.0 * t, 1.5, 3.0};
}

/// What is in a paths.json: no lengths, no parts.
PathFrames frames_of(const Scene& scene, const Options& options) {
    Scene placed = scene;
    PathFrames frames{.name = "frames"};
    for (int k = 0; k <= static_cast<int>(kSeconds / kStep + 0.5); ++k) {
        const double time = kStep * k;
        placed.sources[0].position = source_at(time);
        Simulator simulator(placed, options);
        simulator.set_time(time);
        std::vector<Path> paths = std::move(simulator.run().front().paths);
        for (Path& path : paths) {
            path.length = path.delay = 0.0;
            path.parts.clear();
        }
        frames.speed_of_sound = speed_of_sound(options.air);
        const Pose listener = placed.pose_at(placed.listeners[0], time);
        frames.instants.push_back({.time = time,
                                   .paths = std::move(paths),
                                   .listener_front = listener.front,
                                   .listener_up = listener.up});
    }
    return frames;
}

std::vector<double> noise() {
    std::vector<double> samples;
    for (std::uint64_t n = 0; n < static_cast<std::uint64_t>(kSeconds * kRate); ++n) {
        samples.push_back(random(3, 0, n) - 0.5);
    }
    return samples;
}

/// The level of the difference from what is heard in the scene itself.
double difference_db(const Scene& scene, const Options& options, ResponseFormat format = {}) {
    format.sample_rate = kRate;
    const MovingPair pair{
        .source_path = Trajectory({{0.0, source_at(0.0)}, {kSeconds, source_at(kSeconds)}}),
        .step = kStep};
    const auto expected = render_moving_pair(scene, options, format, pair, noise());
    const auto found = render_path_frames(frames_of(scene, options), format, noise());
    EXPECT_EQ(found.signal.channels.size(), expected.signal.channels.size());
    double difference = 0.0, energy = 0.0;
    for (std::size_t channel = 0; channel < expected.signal.channels.size(); ++channel) {
        const std::vector<double>& a = expected.signal.channels[channel];
        const std::vector<double>& b = found.signal.channels[channel];
        for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
            difference += (a[n] - b[n]) * (a[n] - b[n]);
            energy += a[n] * a[n];
        }
    }
    return 10.0 * std::log10(difference / energy);
}

Scene room() {
    Scene scene = shoebox_room({9.0, 4.0, 7.0});
    scene.sources = {{.name = "s", .node = -1, .position = source_at(0.0)}};
    scene.listeners = {{.name = "l", .node = -1, .position = {6.0, 1.2, 5.5}}};
    return scene;
}

TEST(PathFrames, SoundAsTheirSceneWhereWallsStay) {
    EXPECT_LT(difference_db(room(), {.specular_order = 3}), -100.0);
}

TEST(PathFrames, HaveTheChannelsOfTheirScene) {
    Scene scene = room();
    scene.listeners[0].looks_at = Vec3(1.0, 2.0, 1.0);
    for (const ResponseFormat& format :
         {ResponseFormat{.channels = Channels::ambisonic, .ambisonic_order = 3},
          ResponseFormat{.channels = Channels::binaural, .hrir_set = io::default_hrir_set()}}) {
        EXPECT_LT(difference_db(scene, {.specular_order = 2}, format), -100.0);
    }
}

// A plate that rises: its mirror is interpolated between the instants.
TEST(PathFrames, SoundAsTheirSceneWhereAWallMoves) {
    SceneWithMovingPart scene(room(), Vec3(20.0), Vec3(21.0));
    scene.add_box({0.5, 0.3, 0.5}, {8.5, 0.4, 6.5}, 0, true);
    const double level =
        difference_db(scene.finish(straight_way({0.0, 0.3, 0.0})), {.specular_order = 2});
    EXPECT_LT(level, -60.0);
    RecordProperty("difference_db", std::to_string(level));
}

// Sound round the edge of a screen. The parts of its pressure are not told, their sum is.
TEST(PathFrames, FollowTheLengthOfDiffractedPaths) {
    SceneWithMovingPart scene(room(), Vec3(20.0), Vec3(21.0));
    scene.add_box({3.0, 0.2, 4.0}, {5.0, 2.0, 4.1}, 0);
    scene.add_box({0.2, 3.5, 0.2}, {0.4, 3.6, 0.4}, 0, true);
    const PathFrames frames =
        frames_of(scene.finish(straight_way(Vec3(0.0))), {.specular_order = 1, .diffraction = 1});
    const auto bends = [](const Path& path) { return path.kind == PathKind::diffracted; };
    for (const PathFrame& frame : frames.instants) {
        EXPECT_TRUE(std::any_of(frame.paths.begin(), frame.paths.end(), bends)) << frame.time;
    }
    const MovingSound sound = render_path_frames(frames, {.sample_rate = kRate}, noise());
    EXPECT_EQ(sound.instants, frames.instants.size());
}

TEST(PathFrames, RefuseWhatIsNoMotion) {
    const PathFrames good = frames_of(room(), {.specular_order = 1});
    const auto fails = [&](const std::function<void(PathFrames&)>& change) {
        PathFrames frames = good;
        change(frames);
        EXPECT_THROW(render_path_frames(frames, {.sample_rate = kRate}, noise()), Error);
    };
    fails([](PathFrames& frames) { frames.instants.resize(1); });
    fails([](PathFrames& frames) { frames.instants.clear(); });
    fails([](PathFrames& frames) { frames.instants[1].time = frames.instants[0].time; });
    fails([](PathFrames& frames) { frames.instants[1].time = 1e-6; });
    // Nothing moves, but what changes over a denormal time has no rate.
    fails([](PathFrames& frames) {
        frames.instants[1].paths = frames.instants[0].paths;
        frames.instants[1].time = std::nextafter(frames.instants[0].time, 1.0);
    });
    fails([](PathFrames& frames) { frames.instants[2].paths[1].points.front().x += 0.1; });
    fails([](PathFrames& frames) {
        Path& path = frames.instants[0].paths[1];
        path.edges = {{Vec3(0.0), Vec3(1.0)}, {Vec3(1.0), Vec3(2.0)}};
    });
    // A reflection straight on, at a triangle of which nothing else is known.
    fails([](PathFrames& frames) {
        Path& path = frames.instants[0].paths[0];
        path.points.insert(path.points.begin() + 1, 0.5 * (path.points[0] + path.points[1]));
        path.triangles = {4000000000U};
    });
}

}  // namespace
}  // namespace earshot::propagation
