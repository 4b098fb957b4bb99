// SPDX-License-Identifier: MIT
// Time of a response of a shoe-box by its image lattice: images, assembly and the whole job.
#include "earshot/audio/impulse_response.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <glm/vec3.hpp>

#include "harness.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace {

using earshot::geometry::Vec3;
using earshot::propagation::Scene;

Scene shoebox(const Vec3& size, int microphones) {
    Scene scene = earshot::propagation::shoebox_room(size);
    scene.materials.resize(1);  // the walls are alike
    scene.materials[0].name = "wall";
    std::fill(scene.material_of_triangle.begin(), scene.material_of_triangle.end(), 0U);
    scene.sources = {{.name = "source", .position = {2.0, 1.7, 1.5}}};
    for (int i = 0; i < microphones; ++i) {
        scene.listeners.push_back(
            {.name = "m" + std::to_string(i), .position = {6.1 + 0.03 * i, 1.2, 4.3 - 0.05 * i}});
    }
    return scene;
}

struct Job {
    int order = 0;
    int microphones = 1;
    bool has_bands = false;  // else all frequencies alike
    int repeats = 5;
    bool measures_paths = true;
};

void measure(const Job& job) {
    using earshot::propagation::EnergyCoefficient;
    Scene scene = shoebox({8.0, 3.5, 6.0}, job.microphones);
    scene.materials[0].scattering = EnergyCoefficient(0.0);
    scene.materials[0].absorption =
        job.has_bands
            ? EnergyCoefficient({{125, 0.10}, {250, 0.10}, {500, 0.11}, {1000, 0.12}, {4000, 0.14}})
            : EnergyCoefficient(0.1);
    earshot::propagation::Options options = {.specular_order = job.order,
                                             .air_absorption = job.has_bands};
    const earshot::audio::Assembler assembler(options.bands, 48000.0);
    std::vector<earshot::propagation::PairResult> pairs;
    const auto find = [&](bool report_paths) {
        options.report_paths = report_paths;
        earshot::propagation::Simulator simulator(scene, options);
        pairs = simulator.run();
    };
    double sum = 0.0;
    const auto assemble = [&] {
        for (const auto& pair : pairs) {
            sum += assembler.assemble(pair.arrivals).samples[1000];
        }
    };
    const double paths =
        job.measures_paths ? bench::median_processor_time(job.repeats, [&] { find(true); }) : 0.0;
    const double images = bench::median_processor_time(job.repeats, [&] { find(false); });
    const double assembly = bench::median_processor_time(job.repeats, assemble);
    const double all = bench::median_processor_time(job.repeats, [&] {
        find(false);
        assemble();
    });
    std::printf("%s %d %d %zu %.3f %.3f %.3f %.3f\n",
                job.has_bands ? "bands" : "flat",
                job.order,
                job.microphones,
                pairs.front().arrivals.size(),
                1e3 * paths,
                1e3 * images,
                1e3 * assembly,
                1e3 * all);
    std::fflush(stdout);
    if (sum == 1.0) {  // never: keeps the work
        std::puts("");
    }
}

int run(int argc, char** argv) {
    if (argc != 1 && argc != 2 && argc != 5) {
        std::fprintf(stderr, "usage: bench_shoebox [REPEATS [flat|bands ORDER MICROPHONES]]\n");
        return 2;
    }
    const int repeats = argc > 1 ? std::atoi(argv[1]) : 5;
    std::puts("walls order microphones images ms_with_paths ms_images ms_assembly ms_in_all");
    if (argc == 5) {
        measure({.order = std::atoi(argv[3]),
                 .microphones = std::atoi(argv[4]),
                 .has_bands = std::string_view(argv[2]) == "bands",
                 .repeats = repeats,
                 .measures_paths = false});
        return 0;
    }
    for (const bool has_bands : {false, true}) {
        for (const int microphones : {1, 8}) {
            for (const int order : {10, 17, 30}) {
                measure({.order = order,
                         .microphones = microphones,
                         .has_bands = has_bands,
                         .repeats = repeats});
            }
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_shoebox", argc, argv, run);
}
