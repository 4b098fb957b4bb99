// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::capi {

/// Segments per call for a tree of that many bytes. A block stays in the innermost caches; a large
/// tree is traversed in an order of the block's segments, of which more are closer to each other.
constexpr std::size_t segments_per_block(std::size_t tree_bytes) noexcept {
    constexpr std::size_t kLargeTree = std::size_t{128} << 20U;
    return tree_bytes < kLargeTree ? 4096 : 32768;
}

/// Segments between points of two arrays (count, 3), block by block: calls ask(segments, number of
/// the first), from several threads at the same time. Throws Failure for an end that is not finite,
/// of the first block that has one, perhaps after some calls.
template <typename Ask>
void for_segments(const double* from,
                  const double* to,
                  std::size_t count,
                  std::size_t block,
                  Executor& executor,
                  const Ask& ask) {
    require_array(reinterpret_cast<const geometry::Vec3*>(from), count, "from");
    require_array(reinterpret_cast<const geometry::Vec3*>(to), count, "to");
    executor.for_each(count, block, [&](std::size_t first, std::size_t end) {
        const std::size_t size = end - first;
        const auto begins = require_points(from + 3 * first, size, "from", first);
        const auto ends = require_points(to + 3 * first, size, "to", first);
        std::vector<geometry::Segment> segments(size);
        for (std::size_t i = 0; i < size; ++i) {
            segments[i] = {begins[i], ends[i]};
        }
        ask(std::span<const geometry::Segment>(segments), first);
    });
}

}  // namespace earshot::capi
