// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/instances.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/overlap.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::bvh::brute_force {

// The queries of ray.h, all_hits.h, closest_point.h, overlap.h and instances.h answered by trying
// every instance and triangle: oracle of tests and baseline of benchmarks. Same decisions, same
// bits.

std::optional<geometry::Hit> closest_hit(const geometry::MeshView& mesh,
                                         const geometry::Ray& ray) noexcept;

std::vector<geometry::Hit> all_hits(const geometry::MeshView& mesh, const geometry::Ray& ray);

bool occluded(const geometry::MeshView& mesh, const geometry::Segment& segment) noexcept;

std::optional<geometry::ClosestPoint> closest_point(const geometry::MeshView& mesh,
                                                    const geometry::Vec3& point,
                                                    double max_distance);

std::vector<geometry::ClosestPoint> closest_triangles(const geometry::MeshView& mesh,
                                                      const geometry::Vec3& point,
                                                      std::size_t count,
                                                      double max_distance);

std::optional<InstanceHit> closest_hit(const Instances& instances,
                                       const geometry::Ray& ray) noexcept;

bool occluded(const Instances& instances, const geometry::Segment& segment) noexcept;

template <geometry::OverlapRegion Region>
std::vector<geometry::TriangleId> overlapping(const geometry::MeshView& mesh,
                                              const Region& region) {
    std::vector<geometry::TriangleId> found;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = geometry::corners(mesh, i);
        if (region.touches(a, b, c)) {
            found.push_back(static_cast<geometry::TriangleId>(i));
        }
    }
    return found;
}

}  // namespace earshot::bvh::brute_force
