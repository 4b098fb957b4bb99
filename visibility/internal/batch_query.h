// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/line_of_sight.h"

#include <cstddef>

namespace earshot::visibility {

// Batches of segments in the order given; answer i is that of segment i.

void query_batch(const bvh::MeshBvh& bvh,
                 std::span<const geometry::Segment> segments,
                 const ExclusionMask& excluded,
                 std::span<std::uint8_t> visible,
                 Executor& executor);

void query_batch(const bvh::MeshBvh& bvh,
                 std::span<const geometry::Segment> segments,
                 const ExclusionMask& excluded,
                 std::span<std::optional<Blocker>> blockers,
                 Executor& executor);

/// Segments per batch: enough for neighbours to be near each other once sorted, and few enough for
/// their copies to stay in the cache.
inline constexpr std::size_t kBatchSize = std::size_t{1} << 18U;

}  // namespace earshot::visibility
