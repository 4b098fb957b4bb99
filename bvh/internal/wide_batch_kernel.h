// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <optional>
#include <span>

namespace earshot::bvh {

// Compiled for every instruction set. Precondition: the tree is not empty.

/// Sets hits[i] to closest_hit() of rays[i].
void find_closest_of_many(const WideTree& tree,
                          const geometry::MeshView& mesh,
                          std::span<const geometry::Ray> rays,
                          std::span<std::optional<geometry::Hit>> hits) noexcept;

/// Sets blocked[i] to occluded() of segments[i].
void find_any_of_many(const WideTree& tree,
                      const geometry::MeshView& mesh,
                      std::span<const geometry::Segment> segments,
                      std::span<std::uint8_t> blocked) noexcept;

}  // namespace earshot::bvh
