// SPDX-License-Identifier: MIT
//
// bench_deforming_scene SCENE [RAYS [FRAMES [THREADS]]]: what a further instant of a scene that
// deforms costs, against a simulator that is made afresh for it, in processor time.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using earshot::Executor;
using earshot::propagation::Options;
using earshot::propagation::PairResult;
using earshot::propagation::Scene;
using earshot::propagation::Simulator;

std::uint64_t digest_of(const std::vector<PairResult>& pairs) {
    earshot::Digest digest;
    for (const PairResult& pair : pairs) {
        for (const auto& path : pair.paths) {
            digest.add(path.length);
        }
        for (const auto& energies : pair.late.energy) {
            digest.add(energies[0]);
        }
    }
    return digest.value();
}

/// Milliseconds of processor time, medians over the frames.
struct Row {
    double prepare = 0.0, run = 0.0, fresh = 0.0;
};

Row measure(const Scene& scene,
            const Options& options,
            int frames,
            double step,
            Executor& executor,
            bool& agree) {
    Simulator simulator(scene, options, executor);
    simulator.run(executor);
    std::vector<double> prepare, run, fresh;
    for (int frame = 1; frame <= frames; ++frame) {
        const double time = step * frame;
        std::vector<PairResult> followed, anew;
        prepare.push_back(bench::times_of([&] { simulator.set_time(time, executor); }).processor);
        run.push_back(bench::times_of([&] { followed = simulator.run(executor); }).processor);
        fresh.push_back(bench::times_of([&] {
                            Simulator other(scene, options, executor);
                            other.set_time(time, executor);
                            anew = other.run(executor);
                        }).processor);
        agree = agree && digest_of(followed) == digest_of(anew);
    }
    return {1e3 * bench::median(prepare), 1e3 * bench::median(run), 1e3 * bench::median(fresh)};
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "bench_deforming_scene SCENE [RAYS [FRAMES [THREADS]]]\n");
        return 2;
    }
    const Scene scene = earshot::io::load_scene(argv[1]).scene;
    const auto rays = static_cast<std::size_t>(argc > 2 ? std::atoll(argv[2]) : 0);
    const int frames = argc > 3 ? std::atoi(argv[3]) : 10;
    Executor executor(argc > 4 ? std::atoi(argv[4]) : 1);
    constexpr double kStep = 0.1;  // seconds from one instant to the next
    std::printf("%zu triangles, %zu rays, %d instants, %d threads; ms of processor time\n\n",
                scene.mesh.triangles().size(),
                rays,
                frames,
                executor.threads());
    std::printf("| order | set_time | run | both | a fresh simulator | share |\n");
    std::printf("| ---: | ---: | ---: | ---: | ---: | ---: |\n");
    bool agree = true;
    for (const int order : {0, 1, 2}) {
        const Row row =
            measure(scene, {.specular_order = order, .rays = rays}, frames, kStep, executor, agree);
        const double both = row.prepare + row.run;
        std::printf("| %d | %.1f | %.1f | %.1f | %.1f | %.2f |\n",
                    order,
                    row.prepare,
                    row.run,
                    both,
                    row.fresh,
                    both / row.fresh);
    }
    std::printf("\nThe results %s those of fresh simulators.\n", agree ? "equal" : "DIFFER FROM");
    return agree ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_deforming_scene", argc, argv, run);
}
