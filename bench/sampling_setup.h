// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/io/scene_file.h"
#include "earshot/visibility/region.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <vector>

namespace earshot {

// Curves of what was found (a member of their points) against the number of rays.

/// What was found after so many rays.
template <typename Point>
std::uint64_t found_after(const std::vector<Point>& curve,
                          std::uint64_t Point::*found,
                          std::uint64_t rays) {
    const auto after = std::upper_bound(
        curve.begin(), curve.end(), rays, [](std::uint64_t value, const Point& point) {
            return value < point.rays;
        });
    return after == curve.begin() ? 0 : (*std::prev(after)).*found;
}

/// The number of rays after which so much was found; 0 if it never was.
template <typename Point>
std::uint64_t rays_until(const std::vector<Point>& curve,
                         std::uint64_t Point::*found,
                         std::uint64_t count) {
    const auto place = std::find_if(
        curve.begin(), curve.end(), [&](const Point& point) { return point.*found >= count; });
    return place == curve.end() ? 0 : place->rays;
}

/// Throws Error unless the text is X,Y,Z.
inline geometry::Vec3 point_of(const char* text) {
    geometry::Vec3 point;
    if (std::sscanf(text, "%lf,%lf,%lf", &point.x, &point.y, &point.z) != 3) {
        throw Error(text, "is not of the form X,Y,Z", "give metres");
    }
    return point;
}

/// The scene, region and hierarchy of a benchmark of sampling, from the arguments [SCENE [X,Y,Z
/// X,Y,Z
/// ...]].
struct SamplingSetup {
    SamplingSetup(int argc, char** argv, const visibility::ViewRegion& default_region)
        : scene(io::load_scene(argc > 1 ? argv[1] : "scenes/city.gltf").scene),
          positions(scene.mesh.positions_at(0.0)),
          mesh{positions, scene.mesh.triangles()},
          hierarchy(mesh, {}, executor),
          region(argc > 3 ? visibility::ViewRegion{point_of(argv[2]), point_of(argv[3])}
                          : default_region) {}

    Executor executor{};
    propagation::Scene scene;
    std::vector<geometry::Vec3> positions;
    geometry::MeshView mesh;
    bvh::DeformableBvh hierarchy;
    visibility::ViewRegion region;
};

}  // namespace earshot
