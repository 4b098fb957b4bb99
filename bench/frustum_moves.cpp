// SPDX-License-Identifier: MIT
//
// bench_frustum_moves SCENE [ORDER [THREADS [LISTENERS]]]: what it costs to follow a source or a
// listener that moves, against searching afresh.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

namespace {

using earshot::Executor;
using earshot::frustum::FinderOptions;
using earshot::frustum::PathFinder;
using earshot::frustum::TraceResult;
using earshot::geometry::Vec3;

constexpr int kRepeats = 5;

/// The minimum of a few runs.
template <typename Work>
double milliseconds_of(Work&& work) {
    return 1e3 * bench::min_times_of(kRepeats, work).clock;
}

std::uint64_t digest_of(const TraceResult& result) {
    earshot::Digest digest;
    for (const auto& path : result.paths) {
        digest.add(path.listener);
        digest.add(path.length);
    }
    return digest.value();
}

void measure(const char* name,
             const earshot::frustum::SceneView& scene_view,
             const FinderOptions& options,
             const Vec3& source,
             const std::vector<Vec3>& listeners,
             Executor& executor) {
    const PathFinder finder(scene_view, options);
    auto from = finder.trace_source(source, {}, executor);
    auto to = finder.trace_listeners(listeners, executor);
    TraceResult kept, fresh;
    const double source_ms =
        milliseconds_of([&] { from = finder.trace_source(source, {}, executor); });
    const double listener_ms =
        milliseconds_of([&] { to = finder.trace_listeners(listeners, executor); });
    const double connect_ms = milliseconds_of([&] { kept = finder.connect(from, to, executor); });
    const double fresh_ms = milliseconds_of([&] {
        fresh = finder.find(source, finder.trace_listeners(listeners, executor), {}, executor);
    });
    std::printf("| %s | %zu | %zu | %llu | %zu | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |%s\n",
                name,
                from.frusta(),
                to.frusta(),
                static_cast<unsigned long long>(kept.statistics.candidates),
                kept.paths.size(),
                static_cast<double>(from.bytes()) / 1048576.0,
                source_ms,
                listener_ms,
                connect_ms,
                listener_ms + connect_ms,
                fresh_ms,
                digest_of(kept) == digest_of(fresh) ? "" : " DIFFERENT ANSWERS");
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_frustum_moves SCENE [ORDER [THREADS [LISTENERS]]]\n");
        return 2;
    }
    const int order = argc > 2 ? std::atoi(argv[2]) : 3;
    Executor executor(argc > 3 ? std::atoi(argv[3]) : 1);
    const auto loaded = earshot::io::load_scene(argv[1]);
    const auto& scene = loaded.scene;
    const earshot::propagation::Simulator simulator(scene, {}, executor);
    const Vec3 source = scene.position_at(scene.sources.front(), 0.0);
    const Vec3 centre = scene.position_at(scene.listeners.front(), 0.0);
    std::vector<Vec3> listeners(argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1, centre);
    for (std::size_t i = 1; i < listeners.size(); ++i) {
        const auto shift = [&](std::uint64_t axis) { return earshot::random(1, axis, i) - 0.5; };
        listeners[i] += Vec3(4.0 * shift(0), 0.2 * shift(1), 4.0 * shift(2));
    }
    std::printf("%s, order %d, %d threads, %zu listeners\n\n",
                argv[1],
                order,
                executor.threads(),
                listeners.size());
    std::printf(
        "| frusta | source's | listeners' | candidates | paths | kept, MiB | trace source, ms "
        "| trace listeners, ms | connect, ms | listeners move, ms | afresh, ms |\n"
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    FinderOptions options;
    options.trace.max_order = order;
    options.trace.box_lattice = false;
    measure("bidirectional", simulator.scene_view(), options, source, listeners, executor);
    options.forward_only = true;
    measure("forward only", simulator.scene_view(), options, source, listeners, executor);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_frustum_moves", argc, argv, run);
}
