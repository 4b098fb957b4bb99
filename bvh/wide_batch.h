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

// The queries of wide_ray.h for many rays or segments at once, faster than one by one: neighbours
// with a common origin traverse the tree as a packet, and the traversals of other rays are
// interleaved to hide the latency of memory. Results are in the order of the rays, the same for any
// executor.
// Precondition: the tree was built over or refitted to this mesh.

/// closest_hit() of every ray.
std::vector<std::optional<geometry::Hit>> closest_hits(const WideTree& tree,
                                                       const geometry::MeshView& mesh,
                                                       std::span<const geometry::Ray> rays,
                                                       Executor& executor = Executor::serial());

/// closest_hit() of every ray into a caller's array. `interrupt` is polled every few thousand rays;
/// returns false if it stopped the work, and then only some of the hits are set. Precondition: as
/// many hits as rays.
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

/// occluded() of every segment into a caller's array, with the interruption and the precondition of
/// closest_hits().
bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              std::span<const geometry::Segment> segments,
              std::span<std::uint8_t> blocked,
              Executor& executor = Executor::serial(),
              const Interrupt& interrupt = {});

/// Rays that start on surfaces, as reflections do: ray i starts beside origin_triangles[i] and goes
/// away from it, so that it cannot hit it, and the triangle is excluded from its search. As many
/// triangles as rays.
struct SecondaryRays {
    std::span<const geometry::Ray> rays;
    std::span<const geometry::TriangleId> origin_triangles;
};

/// closest_hit() of every secondary ray, into a caller's array of as many hits.
void closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const SecondaryRays& secondary,
                  std::span<std::optional<geometry::Hit>> hits);

/// Segments that start on surfaces, as shadow rays of reflections do, with the triangles that are
/// excluded from their searches: see SecondaryRays.
struct SecondarySegments {
    std::span<const geometry::Segment> segments;
    std::span<const geometry::TriangleId> origin_triangles;
};

/// occluded() of every secondary segment, 1 or 0, into a caller's array of as many flags.
void occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const SecondarySegments& secondary,
              std::span<std::uint8_t> blocked);

}  // namespace earshot::bvh
