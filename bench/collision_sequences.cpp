// SPDX-License-Identifier: MIT
//
// bench_collision_sequences [THREADS]: time per frame of continuous collision detection, with
// self-collision, in made sequences: a cloth of 92,450 triangles that falls over a ball, ten layers
// of a skirt of 49,920 that swing, and 114 balls of 145,920 that fly about.

#include "support/collision_sequences.h"

#include "earshot/base/error.h"
#include "earshot/collision/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using earshot::Executor;
using earshot::collision::ContactOptions;
using earshot::collision::World;
using earshot::collision::WorldStatistics;
using earshot::support::Part;

struct Variant {
    const char* name;
    ContactOptions options;
};

struct Measured {
    double median_ms = 0.0, worst_ms = 0.0;
    WorldStatistics sum;
    std::size_t contacts = 0;
};

constexpr int kFrames = 30;

Measured measure(const std::vector<Part>& parts,
                 const ContactOptions& options,
                 Executor& executor) {
    World world;
    for (const Part& part : parts) {
        world.add_mesh(part.triangles, part.at(0.0).size());
    }
    std::vector<double> times;
    Measured measured;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            world.update(mesh,
                         parts[mesh].at(frame / double(kFrames)),
                         parts[mesh].at((frame + 1) / double(kFrames)));
        }
        const auto start = std::chrono::steady_clock::now();
        measured.contacts += world.contacts(options, executor).size();
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        times.push_back(1e3 * elapsed.count());
        measured.sum += world.statistics();
    }
    std::sort(times.begin(), times.end());
    measured.median_ms = times[kFrames / 2];
    measured.worst_ms = times.back();
    return measured;
}

void measure(const char* name, const std::vector<Part>& parts, Executor& executor) {
    const std::vector<Variant> variants{
        {"", {.within_meshes = true}},
        {", no front", {.within_meshes = true, .keeps_front = false}},
        {", no patches", {.within_meshes = true, .leaves_out_smooth_patches = false}},
        {", elements as often as they come", {.within_meshes = true, .assigns_elements = false}},
        {", none of these",
         {.within_meshes = true,
          .keeps_front = false,
          .leaves_out_smooth_patches = false,
          .assigns_elements = false}}};
    std::size_t triangles = 0;
    for (const Part& part : parts) {
        triangles += part.triangles.size();
    }
    for (const Variant& variant : variants) {
        const Measured measured = measure(parts, variant.options, executor);
        std::printf("| %s%s | %zu | %.0f | %.0f | %.3f | %.3f | %.3f | %zu |\n",
                    name,
                    variant.name,
                    triangles,
                    measured.median_ms,
                    measured.worst_ms,
                    1e-6 * static_cast<double>(measured.sum.box_tests) / kFrames,
                    1e-6 * static_cast<double>(measured.sum.triangle_pairs) / kFrames,
                    1e-6 * static_cast<double>(measured.sum.elementary_tests) / kFrames,
                    measured.contacts);
    }
}

int run(int argc, char** argv) {
    Executor executor(argc > 1 ? std::atoi(argv[1]) : 1);
    std::printf(
        "%d threads; per frame\n\n| sequence | triangles | median ms | worst ms | M box tests | M "
        "pairs | M elementary tests | contacts of all frames |\n| --- | ---: | ---: | ---: | ---: "
        "| ---: | ---: | ---: |\n",
        executor.threads());
    measure("cloth on ball", earshot::support::cloth_on_ball(215), executor);
    measure("skirt", earshot::support::skirt(208, 12), executor);
    measure("balls", earshot::support::flying_balls(114, 32, 20), executor);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "bench_collision_sequences: %s\n", error.line().c_str());
        return 1;
    }
}
