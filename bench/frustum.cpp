// SPDX-License-Identifier: MIT
//
// bench_frustum SCENE [ORDER [REPEATS]]: time and completeness of frustum tracing against the
// number of sub-frusta, sampled and complete, for all sources and listeners of a scene.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace {

using earshot::frustum::Mode;
using earshot::propagation::Simulator;

using PathKey = std::tuple<std::size_t, std::size_t, std::vector<std::uint32_t>>;

struct Measurement {
    std::set<PathKey> paths;
    std::uint64_t digest = 0;
    std::uint64_t frusta = 0;
    std::uint64_t candidates = 0;
    double seconds = 0.0;  // least of the repeats
};

Measurement measure(const earshot::propagation::Scene& scene,
                    const earshot::propagation::Options& options,
                    int repeats) {
    Measurement result;
    result.seconds = std::numeric_limits<double>::infinity();
    Simulator simulator(scene, options);
    for (int repeat = 0; repeat < repeats; ++repeat) {
        std::vector<earshot::propagation::PairResult> pairs;
        result.seconds =
            std::min(result.seconds, bench::seconds_of([&] { pairs = simulator.run(); }));
        earshot::Digest digest;
        result.paths.clear();
        for (const auto& pair : pairs) {
            for (const auto& path : pair.paths) {
                digest.add(path.length);
                result.paths.emplace(pair.source, pair.listener, path.triangles);
            }
        }
        result.digest = digest.value();
    }
    result.frusta = simulator.statistics().frusta;
    result.candidates = simulator.statistics().candidates;
    return result;
}

void print_row(const char* mode, int resolution, const Measurement& m, const Measurement& all) {
    const auto missed = std::count_if(all.paths.begin(), all.paths.end(), [&](const PathKey& key) {
        return m.paths.count(key) == 0;
    });
    std::printf("%-9s %4d x %-4d %8zu %8td %10llu %10llu %9.1f %12.0f  %016llx\n",
                mode,
                resolution,
                resolution,
                m.paths.size(),
                missed,
                static_cast<unsigned long long>(m.frusta),
                static_cast<unsigned long long>(m.candidates),
                1e3 * m.seconds,
                static_cast<double>(m.frusta) / m.seconds,
                static_cast<unsigned long long>(m.digest));
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_frustum SCENE [ORDER [REPEATS]]\n");
        return 2;
    }
    const int order = argc > 2 ? std::atoi(argv[2]) : 3;
    const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
    const auto loaded = earshot::io::load_scene(argv[1]);
    earshot::propagation::Options options = {.specular_order = order};
    options.box_lattice = false;
    options.resolution = 32;
    const Measurement all = measure(loaded.scene, options, 1);
    std::printf("%s, order %d, 1 thread, least of %d\n", argv[1], order, repeats);
    std::printf(
        "mode      sub-frusta     paths   missed     frusta candidates        ms     frusta/s  "
        "digest\n");
    for (const Mode mode : {Mode::sampled, Mode::complete}) {
        for (const int resolution : {4, 8, 16, 32, 64, 128}) {
            options.mode = mode;
            options.resolution = resolution;
            print_row(mode == Mode::sampled ? "sampled" : "complete",
                      resolution,
                      measure(loaded.scene, options, repeats),
                      all);
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_frustum", argc, argv, run);
}
