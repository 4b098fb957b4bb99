// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace earshot::bvh {

// Many questions at once, over threads: results in the order of the questions, the same for any
// executor. wide_batch.h answers the questions about rays several times faster, for the price of a
// second layout.

/// closest_hit() of every ray.
std::vector<std::optional<geometry::Hit>> closest_hits(const Tree& tree,
                                                       const geometry::MeshView& mesh,
                                                       std::span<const geometry::Ray> rays,
                                                       Executor& executor = Executor::serial());

/// occluded() of every segment: 1 or 0.
std::vector<std::uint8_t> occluded(const Tree& tree,
                                   const geometry::MeshView& mesh,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor = Executor::serial());

/// closest_point() of every point, within `most` metres.
std::vector<std::optional<geometry::ClosestPoint>> closest_points(
    const Tree& tree,
    const geometry::MeshView& mesh,
    std::span<const geometry::Vec3> points,
    double most = std::numeric_limits<double>::infinity(),
    Executor& executor = Executor::serial());

}  // namespace earshot::bvh
