// SPDX-License-Identifier: MIT
//
// bench_frustum_rates [THREADS]: frusta per second and thread in scenes of the sizes that
// Lauterbach 2010 (table 6.1) reports, sampled as there and complete. Scenes are generated: a map
// of blocks and a nave of fluted columns; the theatre is the concert hall of scenes/.

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

namespace {

using earshot::Executor;
using earshot::frustum::Mode;
using earshot::geometry::Mesh;
using earshot::geometry::Vec3;
using earshot::geometry::VertexId;
using earshot::propagation::Scene;

void add_quad(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

void add_box(Mesh& mesh, const Vec3& low, const Vec3& high) {
    const auto at = [&](int i, int j, int k) {
        return Vec3(i == 0 ? low.x : high.x, j == 0 ? low.y : high.y, k == 0 ? low.z : high.z);
    };
    add_quad(mesh, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
    add_quad(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
    add_quad(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
    add_quad(mesh, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
    add_quad(mesh, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
    add_quad(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
}

Scene scene_of(Mesh mesh, const char* name, const Vec3& source, const Vec3& listener) {
    Scene scene;
    scene.name = name;
    scene.materials.resize(1);
    scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    scene.sources = {{.name = "source", .position = source}};
    scene.listeners = {{.name = "listener", .position = listener}};
    scene.mesh = earshot::geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

/// Blocks of a game's map: 12,012 triangles.
Scene make_map() {
    Mesh mesh;
    add_box(mesh, Vec3(-1.0), {201.0, 30.0, 201.0});
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const auto dice = [&](std::uint64_t stream) { return earshot::random(1, stream, i); };
        const Vec3 corner = {198.0 * dice(0), 0.0, 198.0 * dice(1)};
        const bool is_in_the_way =
            std::abs(corner.x - 99.0) < 3.0 && std::abs(corner.z - 99.0) < 3.0;
        add_box(mesh,
                is_in_the_way ? corner + Vec3(0.0, 10.0, 0.0) : corner,
                corner + Vec3(0.5 + 4.0 * dice(2), 10.5 + 5.0 * dice(3), 0.5 + 4.0 * dice(4)));
    }
    return scene_of(std::move(mesh), "map", {100.0, 1.7, 100.0}, {103.0, 1.7, 101.0});
}

/// A nave with sixty columns, fluted and swelling: 196,332 triangles.
Scene make_cathedral() {
    constexpr int kSides = 48, kRings = 34;
    constexpr double kTurn = 6.283185307179586;
    Mesh mesh;
    add_box(mesh, {0.0, 0.0, 0.0}, {90.0, 28.0, 30.0});
    for (int column = 0; column < 60; ++column) {
        const Vec3 foot = {3.0 + 2.9 * (column % 30), 0.0, column < 30 ? 8.0 : 22.0};
        const auto at = [&](int ring, int side) {
            const double angle = kTurn * (side % kSides) / kSides;
            const double height = 27.0 * ring / kRings;
            const double radius =
                (0.7 + 0.04 * std::sin(0.12 * height)) * (side % 2 == 0 ? 1.0 : 0.93);
            return foot + Vec3(radius * std::cos(angle), height, radius * std::sin(angle));
        };
        for (int ring = 0; ring < kRings; ++ring) {
            for (int side = 0; side < kSides; ++side) {
                add_quad(mesh,
                         at(ring, side),
                         at(ring + 1, side),
                         at(ring + 1, side + 1),
                         at(ring, side + 1));
            }
        }
    }
    return scene_of(std::move(mesh), "cathedral", {20.0, 1.7, 15.0}, {60.0, 1.7, 14.0});
}

void measure(const Scene& scene, Mode mode, int order, int resolution, Executor& executor) {
    const earshot::propagation::Simulator simulator(scene, {}, executor);
    const Vec3 source = scene.position_at(scene.sources.front(), 0.0);
    const Vec3 listener = scene.position_at(scene.listeners.front(), 0.0);
    earshot::frustum::TraceResult found;
    const auto trace = [&] {
        found = find_specular_paths(
            simulator.scene_view(),
            source,
            std::span(&listener, 1),
            {.max_order = order, .mode = mode, .resolution = resolution, .box_lattice = false},
            executor);
    };
    const double seconds = bench::min_times_of(3, trace).processor;
    const auto frusta = static_cast<double>(found.statistics.frusta);
    std::printf("| %s | %zu | %zu | %s | %d | %llu | %zu | %.0f | %.0f |\n",
                scene.name.c_str(),
                simulator.geometry().triangles,
                simulator.geometry().facets,
                mode == Mode::sampled ? "sampled" : "complete",
                order,
                static_cast<unsigned long long>(found.statistics.frusta),
                found.paths.size(),
                1e3 * seconds,
                frusta / seconds / 1e3);
}

int run(int argc, char** argv) {
    Executor executor(argc > 1 ? std::atoi(argv[1]) : 1);
    std::printf("%d threads\n\n", executor.threads());
    std::printf(
        "| scene | triangles | facets | mode | order | frusta | paths | ms | thousand frusta/s and "
        "thread |\n| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: |\n");
    const Scene theatre = earshot::io::load_scene("scenes/concert_hall.gltf").scene;
    const Scene map = make_map();
    const Scene cathedral = make_cathedral();
    measure(theatre, Mode::sampled, 6, 32, executor);
    measure(theatre, Mode::complete, 3, 0, executor);
    measure(map, Mode::sampled, 5, 32, executor);
    measure(map, Mode::complete, 3, 0, executor);
    measure(cathedral, Mode::sampled, 5, 32, executor);
    measure(cathedral, Mode::complete, 2, 0, executor);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_frustum_rates", argc, argv, run);
}
