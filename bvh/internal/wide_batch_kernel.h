// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_batch.h"

#include <cstdint>
#include <optional>
#include <span>

namespace earshot::bvh {

// Compiled for every instruction set; `left` may be empty. Precondition: the tree is not empty.

/// Sets hits[i] to closest_hit() of ray i.
void find_closest_of_many(const WideTree& tree,
                          const geometry::MeshView& mesh,
                          const SecondaryRays& secondary_rays,
                          std::span<std::optional<geometry::Hit>> hits) noexcept;

/// Sets blocked[i] to occluded() of segment i.
void find_any_of_many(const WideTree& tree,
                      const geometry::MeshView& mesh,
                      const SecondarySegments& secondary_segments,
                      std::span<std::uint8_t> blocked) noexcept;

}  // namespace earshot::bvh
