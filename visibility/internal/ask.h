// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/line_of_sight.h"

#include <cstddef>

namespace earshot::visibility {

// Many segments in the order given, into places of the same number.

void ask(const bvh::WideTree& tree,
         const geometry::MeshView& mesh,
         std::span<const geometry::Segment> segments,
         const ExclusionMask& excluded,
         std::span<std::uint8_t> seen,
         Executor& executor);

void ask(const bvh::WideTree& tree,
         const geometry::MeshView& mesh,
         std::span<const geometry::Segment> segments,
         const ExclusionMask& excluded,
         std::span<std::optional<Blocker>> blockers,
         Executor& executor);

/// So many are asked at a time: enough for neighbours to be near each other once sorted, and few
/// enough for their copies to stay in the cache.
inline constexpr std::size_t kBatch = std::size_t{1} << 18U;

}  // namespace earshot::visibility
