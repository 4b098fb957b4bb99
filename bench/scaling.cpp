// SPDX-License-Identifier: MIT
//
// bench_scaling [MAX_TRIANGLES [THREADS]]: how the times of the hierarchy grow with the number of
// triangles of a generated city, 1,000 to MAX_TRIANGLES in steps of ten, on one thread and on
// THREADS; then into how many parts the work of building, tracing, frusta and late rays is divided,
// and how much 64 threads could gain at best. Processor time on one thread, else that of the clock.

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/simulator.h"

#include "generated_city.h"
#include "harness.h"
#include "loop_counts.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <vector>

namespace {

using earshot::Executor;
using earshot::bvh::Builder;
using earshot::bvh::BuildOptions;
using earshot::bvh::Tree;
using earshot::bvh::WideTree;
using earshot::geometry::Hit;
using earshot::geometry::Mesh;
using earshot::geometry::Ray;
using earshot::geometry::Vec3;

constexpr std::size_t kRays = 1U << 18;

WideTree build(const Mesh& mesh, const BuildOptions& options, Executor& executor) {
    return WideTree::build(
        Tree::build(earshot::bvh::triangle_boxes(mesh.view(), executor), options, executor),
        mesh.view(),
        executor);
}

/// From points above the city to all sides.
std::vector<Ray> rays_over(const WideTree& tree) {
    const auto& box = tree.box();
    std::vector<Ray> rays(kRays);
    for (std::uint64_t i = 0; i < rays.size(); ++i) {
        const auto at = [&](std::uint64_t stream, std::size_t axis) {
            return earshot::random_between(1,
                                           stream,
                                           i,
                                           static_cast<double>(box.lower[axis]),
                                           static_cast<double>(box.upper[axis]));
        };
        const auto side = [&](std::uint64_t stream) {
            return earshot::random_between(1, stream, i, -1.0, 1.0);
        };
        rays[i] = {{at(0, 0), at(1, 1), at(2, 2)}, {side(3), 0.3 * side(4), side(5)}};
    }
    return rays;
}

double seconds(const Executor& executor, int repeats, const std::function<void()>& work) {
    std::vector<double> times;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        const bench::Times spent = bench::times_of(work);
        times.push_back(executor.threads() == 1 ? spent.processor : spent.clock);
    }
    return bench::median(times);
}

void measure_growth(std::size_t triangles, Executor& executor) {
    const Mesh mesh = bench::generated_city(triangles);
    const int repeats = triangles > 2'000'000 ? 1 : 5;
    const auto count = static_cast<double>(mesh.triangles.size());
    const BuildOptions quick = {.builder = Builder::fast, .max_leaf_size = 8};
    WideTree tree;
    const double fast = seconds(executor, repeats, [&] { tree = build(mesh, quick, executor); });
    const double normal = seconds(executor, repeats, [&] { tree = build(mesh, {}, executor); });
    const double refit = seconds(executor, repeats, [&] { tree.refit(mesh.view(), executor); });
    const std::vector<Ray> rays = rays_over(tree);
    std::vector<std::optional<Hit>> hits(rays.size());
    const double trace =
        seconds(executor, repeats, [&] { closest_hits(tree, mesh.view(), rays, hits, executor); });
    std::printf("| %zu | %d | %.3g | %.0f | %.3g | %.0f | %.3g | %.1f | %.2f | %.1f |\n",
                mesh.triangles.size(),
                executor.threads(),
                1e3 * normal,
                1e9 * normal / count,
                1e3 * fast,
                1e9 * fast / count,
                1e3 * refit,
                1e9 * refit / count,
                1e-6 * static_cast<double>(rays.size()) / trace,
                static_cast<double>(tree.bytes()) / count);
    std::fflush(stdout);
}

void count_parts(const char* name, const std::function<void()>& work) {
    bench::count_loops(work);  // warms up
    const bench::LoopCounts counts = bench::count_loops(work);
    const double outside = std::max(0.0, counts.all - counts.in_loops);
    std::printf("| %s | %.1f | %zu | %zu | %.1f | %.0f |\n",
                name,
                1e3 * counts.all,
                counts.loops,
                counts.max_chunks,
                100.0 * outside / counts.all,
                counts.all / (outside + counts.bound_64));
    std::fflush(stdout);
}

void measure_parts_of_trees(Executor& executor) {
    const Mesh city = bench::generated_city(1'000'000);
    WideTree tree;
    count_parts("build, `binned_sah`", [&] { tree = build(city, {}, executor); });
    count_parts("build, `fast`", [&] {
        tree = build(city, {.builder = Builder::fast, .max_leaf_size = 8}, executor);
    });
    count_parts("refit", [&] { tree.refit(city.view(), executor); });
    const std::vector<Ray> rays = rays_over(tree);
    std::vector<std::optional<Hit>> hits(rays.size());
    count_parts("262,144 rays", [&] { closest_hits(tree, city.view(), rays, hits, executor); });
}

void measure_parts_of_sound(Executor& executor) {
    const auto hall = earshot::io::load_scene("scenes/concert_hall.gltf").scene;
    const earshot::propagation::Simulator simulator(hall, {}, Executor::serial());
    const Vec3 source = hall.position_at(hall.sources.front(), 0.0);
    const Vec3 listener = hall.position_at(hall.listeners.front(), 0.0);
    count_parts("frusta, hall, order 3", [&] {
        earshot::frustum::find_specular_paths(
            simulator.scene_view(), source, std::span(&listener, 1), {.max_order = 3}, executor);
    });
    const Mesh mesh = {hall.mesh.positions_at(0.0),
                       {hall.mesh.triangles().begin(), hall.mesh.triangles().end()}};
    const earshot::bvh::DeformableBvh bvh(mesh.view());
    std::vector<earshot::propagation::Material> materials(1);
    materials[0].absorption = earshot::propagation::EnergyCoefficient(0.1);
    materials[0].scattering = earshot::propagation::EnergyCoefficient(0.2);
    const std::vector<std::uint32_t> material_of_triangle(mesh.triangles.size(), 0);
    const auto trace = [&](const earshot::propagation::RayOptions& options) {
        earshot::propagation::trace_late_rays({bvh.view(), material_of_triangle, materials},
                                              {.pose = {.position = source}},
                                              std::span(&listener, 1),
                                              options,
                                              executor);
    };
    count_parts("20,000 late rays, hall", [&] { trace({.rays = 20000}); });
    count_parts("late rays until T30 is known to 2 %",
                [&] { trace({.rays = 1'000'000, .max_error = 0.02, .length = 2.0}); });
}

void measure_parts() {
    Executor many(64);
    measure_parts_of_trees(many);
    measure_parts_of_sound(many);
}

int run(int argc, char** argv) {
    const auto most = static_cast<std::size_t>(argc > 1 ? std::atoll(argv[1]) : 1'000'000);
    const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
    std::printf(
        "| triangles | threads | build, ms | ns per triangle | `fast`, ms | ns per triangle | "
        "refit, "
        "ms | ns per triangle | million rays/s | bytes per triangle |\n"
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    Executor one(1), more(threads);
    for (std::size_t triangles = 1000; triangles < 10 * most; triangles *= 10) {
        measure_growth(std::min(triangles, most), one);
        if (threads > 1) {
            measure_growth(std::min(triangles, most), more);
        }
    }
    std::printf(
        "\n| work | ms of processor time | loops | parts of the largest | outside of loops, %% | "
        "64 threads: at most times as fast |\n| --- | ---: | ---: | ---: | ---: | ---: |\n");
    measure_parts();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_scaling", argc, argv, run);
}
