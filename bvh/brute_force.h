// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <optional>

namespace earshot::bvh::brute_force {

// The questions of ray.h answered by trying every triangle: oracle of tests and baseline of
// benchmarks. Same decisions, same bits.

std::optional<geometry::Hit> closest_hit(const geometry::MeshView& mesh,
                                         const geometry::Ray& ray) noexcept;

bool occluded(const geometry::MeshView& mesh, const geometry::Segment& segment) noexcept;

}  // namespace earshot::bvh::brute_force
