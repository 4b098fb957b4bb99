// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/types.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::bvh {

// Many questions of wide_ray.h at once, faster than one by one: neighbours that start from one
// point traverse the tree as a packet, and of the others several are in flight at a time, which
// hides the memory's latency. Results in the order of the questions, the same for any executor.
// Precondition: the tree was built over or refitted to this mesh.

/// closest_hit() of every ray.
std::vector<std::optional<geometry::Hit>> closest_hits(const WideTree& tree,
                                                       const geometry::MeshView& mesh,
                                                       std::span<const geometry::Ray> rays,
                                                       Executor& executor = Executor::serial());

/// The same into a caller's array. `interrupt` is asked every few thousand rays; returns false if
/// it stopped the work, and then only some of the places hold their answers. Precondition: one
/// place per ray.
bool closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  std::span<const geometry::Ray> rays,
                  std::span<std::optional<geometry::Hit>> hits,
                  Executor& executor = Executor::serial(),
                  const Interrupt& interrupt = {});

/// occluded() of every segment: 1 or 0.
std::vector<std::uint8_t> occluded(const WideTree& tree,
                                   const geometry::MeshView& mesh,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor = Executor::serial());

/// The same into a caller's array, with the interruption and the precondition of closest_hits().
bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              std::span<const geometry::Segment> segments,
              std::span<std::uint8_t> blocked,
              Executor& executor = Executor::serial(),
              const Interrupt& interrupt = {});

/// Rays that leave surfaces, as reflections do: ray i starts beside the triangle left[i] and goes
/// away from it, so that it does not meet it and no time is spent on finding that out. As many of
/// each.
struct LeavingRays {
    std::span<const geometry::Ray> rays;
    std::span<const geometry::TriangleId> left;
};

/// closest_hit() of each, into a caller's array of as many places.
void closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const LeavingRays& leaving,
                  std::span<std::optional<geometry::Hit>> hits);

/// The same of segments.
struct LeavingSegments {
    std::span<const geometry::Segment> segments;
    std::span<const geometry::TriangleId> left;
};

/// occluded() of each, 1 or 0, into a caller's array of as many places.
void occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const LeavingSegments& leaving,
              std::span<std::uint8_t> blocked);

}  // namespace earshot::bvh
