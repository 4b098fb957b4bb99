// SPDX-License-Identifier: MIT
//
// bench_incremental SCENES_DIR [UPDATES [ORDER [NAME]]]: what an update costs when one part of a
// scene moves, with what is kept from the update before and without. Paths are compared.

#include "earshot/base/digest.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include "propagation/moving_part.h"
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace {

using earshot::Executor;
using earshot::frustum::TraceStatistics;
using earshot::geometry::Vec3;
using earshot::propagation::Options;
using earshot::propagation::PairResult;
using earshot::propagation::Scene;
using earshot::propagation::Simulator;

/// A scene, and how its source or listener moves by a share of a second.
struct Motion {
    std::string name;
    Scene scene;
    std::function<void(Scene&, double)> move_points{};
};

Motion turning_door(const std::string& scenes, const char* name) {
    return {name, earshot::io::load_scene(scenes + "/" + name).scene, {}};
}

Motion walking_singer(const std::string& scenes) {
    Scene scene = earshot::propagation::hall_with_singer(
        earshot::io::load_scene(scenes + "/concert_hall.gltf").scene);
    return {
        "concert_hall.gltf, a source walks", std::move(scene), earshot::propagation::move_singer};
}

Motion walking_listener(const std::string& scenes) {
    Motion motion = walking_singer(scenes);
    motion.name = "concert_hall.gltf, the listener walks";
    earshot::propagation::Emitter& listener = motion.scene.listeners.front();
    listener.position = motion.scene.position_at(listener, 0.0);
    listener.node = -1;
    motion.move_points = [](Scene& scene, double seconds) {
        scene.listeners.front().position += seconds * Vec3(0.7, 0.0, 0.3);
    };
    return motion;
}

Motion moving_chair(const std::string& scenes) {
    return {"classroom.gltf, a chair moves",
            earshot::propagation::classroom_with_moving_chair(
                earshot::io::load_scene(scenes + "/classroom.gltf").scene),
            {}};
}

Motion moving_bus(const std::string& scenes) {
    return {"city.gltf, a bus passes",
            earshot::propagation::city_with_moving_bus(
                earshot::io::load_scene(scenes + "/city.gltf").scene),
            {}};
}

std::uint64_t digest_of(const std::vector<PairResult>& pairs) {
    earshot::Digest digest;
    for (const PairResult& pair : pairs) {
        for (const auto& path : pair.paths) {
            digest.add(path.length);
            for (const Vec3& point : path.points) {
                digest.add(point.x);
                digest.add(point.y);
                digest.add(point.z);
            }
        }
    }
    return digest.value();
}

void print_row(const char* how, const TraceStatistics& work, std::vector<double> ms, int updates) {
    std::printf("| %s | %.0f | %.0f | %.2f | %.2f |\n",
                how,
                static_cast<double>(work.frusta) / updates,
                static_cast<double>(work.candidates) / updates,
                bench::median(ms),
                *std::max_element(ms.begin(), ms.end()));
}

bool measure(Motion motion, int updates, int order) {
    const double duration = std::max(motion.scene.mesh.duration(), 1.0);
    Options options{.specular_order = order, .keep_traces = true};
    Simulator keeping(motion.scene, options);
    options.keep_traces = false;
    Simulator anew(motion.scene, options);
    keeping.run();
    TraceStatistics kept_work, fresh_work;
    std::vector<double> kept_ms, fresh_ms;
    int different = 0;
    for (int k = 1; k <= updates; ++k) {
        const double t = static_cast<double>(k) / updates;
        if (motion.move_points) {
            motion.move_points(motion.scene, 1.0 / updates);
        }
        const auto run = [&](Simulator& simulator, std::vector<double>& ms, TraceStatistics& work) {
            std::vector<PairResult> pairs;
            ms.push_back(1e3 * bench::times_of([&] {
                                   simulator.set_time(t * duration);
                                   pairs = simulator.run();
                               }).processor);
            work += simulator.statistics();
            return digest_of(pairs);
        };
        const std::uint64_t kept = run(keeping, kept_ms, kept_work);
        different += kept == run(anew, fresh_ms, fresh_work) ? 0 : 1;
    }
    std::printf("\n%s, order %d: %zu triangles, %d updates, paths differ in %d\n\n",
                motion.name.c_str(),
                order,
                motion.scene.mesh.triangles().size(),
                updates,
                different);
    std::printf(
        "| | frusta | verified | median, ms | worst, ms |\n| --- | ---: | ---: | ---: | ---: |\n");
    print_row("kept", kept_work, kept_ms, updates);
    print_row("anew", fresh_work, fresh_ms, updates);
    std::fflush(stdout);
    return different == 0;
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_incremental SCENES_DIR [UPDATES [ORDER [NAME]]]\n");
        return 2;
    }
    const std::string scenes = argv[1];
    const int updates = argc > 2 ? std::atoi(argv[2]) : 200;
    const int order = argc > 3 ? std::atoi(argv[3]) : 3;
    const std::string wanted = argc > 4 ? argv[4] : "";
    bool agree = true;
    const auto measure_if_wanted = [&](const std::string& name, auto&& make) {
        if (wanted.empty() || wanted == name) {
            agree = measure(make(), updates, order) && agree;
        }
    };
    measure_if_wanted("door", [&] { return turning_door(scenes, "door.gltf"); });
    measure_if_wanted("curtain", [&] { return turning_door(scenes, "curtain.gltf"); });
    measure_if_wanted("classroom", [&] { return moving_chair(scenes); });
    measure_if_wanted("city", [&] { return moving_bus(scenes); });
    measure_if_wanted("office", [&] {
        return Motion{"an office of 24 desks, a chair moves",
                      earshot::propagation::furnished_office(4, 6),
                      {}};
    });
    measure_if_wanted("hall", [&] { return walking_singer(scenes); });
    measure_if_wanted("listener", [&] { return walking_listener(scenes); });
    return agree ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_incremental", argc, argv, run);
}
