// SPDX-License-Identifier: MIT
//
// Prints digests of what an outside program computes with the library, through inline functions of
// its headers as well as through compiled ones. The bits must be those of the library's own build,
// whatever optimisation and instruction set the program is compiled for.

#include "earshot/base/digest.h"

#include "earshot/audio/impulse_response.h"
#include "earshot/base/random.h"
#include "earshot/bvh/ray.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/simulator.h"

#include <cstdio>

namespace {

using earshot::Digest;
using earshot::random_between;
using earshot::geometry::Vec3;

constexpr std::uint64_t kSeed = 7;

Vec3 random_point(std::uint64_t index, double size = 1.0) {
    return {random_between(kSeed, 0, index, -size, size),
            random_between(kSeed, 1, index, -size, size),
            random_between(kSeed, 2, index, -size, size)};
}

/// Rays against triangles, half of them aimed at a point of an edge, where the last bit decides.
std::uint64_t digest_of_hits() {
    Digest digest;
    std::uint64_t hits = 0;
    for (std::uint64_t i = 0; i < 200000; ++i) {
        const Vec3 a = random_point(5 * i), b = random_point(5 * i + 1),
                   c = random_point(5 * i + 2);
        const Vec3 origin = random_point(5 * i + 3, 3.0);
        const double fraction = random_between(kSeed, 3, i, 0.0, 1.0);
        const Vec3 target = i % 2 == 0 ? a + fraction * (b - a) : random_point(5 * i + 4);
        const earshot::geometry::PreparedRay ray({origin, target - origin}, 3.0);
        const auto hit = ray.hit(a, b, c, ray.t_max());
        const auto interval =
            ray.box_interval(earshot::geometry::triangle_box(a, b, c), ray.t_max());
        digest.add(interval.min);
        digest.add(interval.max);
        if (hit) {
            ++hits;
            digest.add(hit->t);
            digest.add(hit->u);
            digest.add(hit->v);
        }
    }
    digest.add(hits);
    return digest.value();
}

std::uint64_t digest_of_distances() {
    Digest digest;
    for (std::uint64_t i = 0; i < 50000; ++i) {
        const Vec3 a = random_point(4 * i), b = random_point(4 * i + 1),
                   c = random_point(4 * i + 2);
        const earshot::geometry::PreparedPoint point(random_point(4 * i + 3, 2.0));
        digest.add(point.squared_distance(earshot::geometry::triangle_box(a, b, c)));
        if (const auto found = point.closest_point(a, b, c, 1.5)) {
            digest.add(found->distance);
        }
        const Vec3 direction = earshot::geometry::direction_between(a, b);
        digest.add(direction.x);
        digest.add(direction.y);
        digest.add(direction.z);
    }
    return digest.value();
}

earshot::propagation::Scene room() {
    earshot::propagation::Scene scene;
    scene.name = "room";
    earshot::geometry::Mesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        mesh.positions.push_back({(corner & 1) != 0 ? 5.1 : 0.0,
                                  (corner & 2) != 0 ? 2.9 : 0.1,
                                  (corner & 4) != 0 ? 7.3 : 0.0});
    }
    mesh.triangles = {{0, 2, 1},
                      {1, 2, 3},
                      {4, 5, 6},
                      {5, 7, 6},
                      {0, 1, 4},
                      {1, 5, 4},
                      {2, 6, 3},
                      {3, 6, 7},
                      {0, 4, 2},
                      {2, 4, 6},
                      {1, 3, 5},
                      {3, 7, 5}};
    scene.mesh = earshot::geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.materials.resize(1);
    scene.material_of_triangle.assign(12, 0);
    scene.sources = {{"s", -1, {1.2, 1.5, 2.3}, {}}};
    scene.listeners = {{"l", -1, {3.7, 1.3, 5.9}, {}}};
    return scene;
}

std::uint64_t digest_of_response() {
    Digest digest;
    const earshot::propagation::Scene scene = room();
    earshot::propagation::Simulator simulator(scene, {.specular_order = 4});
    const auto pairs = simulator.run();
    for (const auto& path : pairs[0].paths) {
        digest.add(path.length);
        digest.add(path.delay);
        for (const double pressure : path.pressure) {
            digest.add(pressure);
        }
        for (const std::uint32_t triangle : path.triangles) {
            digest.add(std::uint64_t{triangle});
        }
    }
    const auto response = earshot::audio::assemble(earshot::audio::Bands::octaves(),
                                                   earshot::propagation::arrivals_of(pairs[0]));
    for (const double sample : response.samples) {
        digest.add(sample);
    }
    return digest.value();
}

}  // namespace

int main() {
    std::printf("hits %016llx\ndistances %016llx\nresponse %016llx\n",
                static_cast<unsigned long long>(digest_of_hits()),
                static_cast<unsigned long long>(digest_of_distances()),
                static_cast<unsigned long long>(digest_of_response()));
    return 0;
}
