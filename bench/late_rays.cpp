// SPDX-License-Identifier: MIT
//
// bench_late_rays [THREADS]: million bounces per second and thread of late rays in a box of 12 and
// of 3,072 triangles, in one without walls across an axis and in the concert hall, one listener,
// absorption 0.1, scattering 0.2. Best of five; the time of the clock, and the processor's for all
// threads, which other programs on the machine do not lengthen as much.

#include "earshot/propagation/late_rays.h"

#include "earshot/base/error.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <vector>

namespace {

using earshot::Executor;
using earshot::geometry::Mesh;
using earshot::geometry::Vec3;
using earshot::geometry::VertexId;
using namespace earshot::propagation;

/// A box whose faces are cut into n x n squares.
Mesh box(const Vec3& size, unsigned n) {
    Mesh mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const auto first = static_cast<VertexId>(mesh.positions.size());
        for (unsigned i = 0; i <= n; ++i) {
            for (unsigned k = 0; k <= n; ++k) {
                Vec3 point(0.0);
                point[axis] = face % 2 == 0 ? 0.0 : size[axis];
                point[(axis + 1) % 3] = size[(axis + 1) % 3] * i / n;
                point[(axis + 2) % 3] = size[(axis + 2) % 3] * k / n;
                mesh.positions.push_back(point);
            }
        }
        for (unsigned i = 0; i < n; ++i) {
            for (unsigned k = 0; k < n; ++k) {
                const VertexId corner = first + i * (n + 1) + k;
                mesh.triangles.push_back({corner, corner + n + 1, corner + n + 2});
                mesh.triangles.push_back({corner, corner + n + 2, corner + 1});
            }
        }
    }
    return mesh;
}

void measure(const char* name,
             const Mesh& mesh,
             const Vec3& source,
             const Vec3& listener,
             Executor& executor) {
    std::vector<Material> materials(1);
    materials[0].absorption = EnergyCoefficient(0.1);
    materials[0].scattering = EnergyCoefficient(0.2);
    const std::vector<std::uint32_t> material_of_triangle(mesh.triangles.size(), 0);
    const earshot::bvh::DeformableBvh bvh(mesh.view());
    const RayScene scene = {bvh.view(), material_of_triangle, materials};
    std::uint64_t bounces = 0;
    const auto trace = [&] {
        bounces = trace_late_rays(scene,
                                  {.pose = {.position = source}},
                                  std::span(&listener, 1),
                                  {.rays = 20000},
                                  executor)
                      .balance.bounces;
    };
    const bench::Times best = bench::min_times_of(5, trace);
    const double millions = 1e-6 * static_cast<double>(bounces);
    std::printf("| %s | %zu | %llu | %.0f | %.2f | %.2f |\n",
                name,
                mesh.triangles.size(),
                static_cast<unsigned long long>(bounces),
                1e3 * best.clock,
                millions / best.clock / executor.threads(),
                millions / best.processor);
}

int run(int argc, char** argv) {
    Executor executor(argc > 1 ? std::atoi(argv[1]) : 1);
    std::printf("%d threads\n\n", executor.threads());
    std::printf("| scene | triangles | bounces | ms | M bounces/s and thread | per processor |\n");
    std::printf("| --- | ---: | ---: | ---: | ---: | ---: |\n");
    const Vec3 size = {8.0, 3.5, 6.0};
    measure("box", box(size, 1), {2.0, 1.2, 1.5}, {5.5, 1.6, 4.0}, executor);
    measure("box", box(size, 16), {2.0, 1.2, 1.5}, {5.5, 1.6, 4.0}, executor);
    // No wall lies across an axis.
    Mesh turned = box(size, 16);
    const auto turn = [](const Vec3& p) {
        return Vec3(0.8 * p.x - 0.6 * p.z, 0.96 * p.y + 0.28 * p.x, 0.6 * p.x + 0.8 * p.z);
    };
    for (Vec3& position : turned.positions) {
        position = turn(position);
    }
    measure("box, askew", turned, turn({2.0, 1.2, 1.5}), turn({5.5, 1.6, 4.0}), executor);
    const auto hall = earshot::io::load_scene("scenes/concert_hall.gltf").scene;
    const Mesh mesh = {hall.mesh.positions_at(0.0),
                       {hall.mesh.triangles().begin(), hall.mesh.triangles().end()}};
    measure("concert hall",
            mesh,
            hall.position_at(hall.sources.front(), 0.0),
            hall.position_at(hall.listeners.front(), 0.0),
            executor);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_late_rays", argc, argv, run);
}
