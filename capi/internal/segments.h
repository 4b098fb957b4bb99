// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/checks.h"
#include "earshot/geometry/types.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::capi {

/// Segments between points of two arrays (count, 3), some thousand at a time, which stay in the
/// processor's caches: calls ask(segments, number of the first). Throws Failure for ends that are
/// not finite, perhaps after some calls.
template <typename Ask>
void for_segments(const double* from, const double* to, std::size_t count, const Ask& ask) {
    constexpr std::size_t kBlock = 32768;
    require_array(reinterpret_cast<const geometry::Vec3*>(from), count, "from");
    require_array(reinterpret_cast<const geometry::Vec3*>(to), count, "to");
    std::vector<geometry::Segment> segments(std::min(count, kBlock));
    for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t size = std::min(kBlock, count - first);
        const auto begins = require_points(from + 3 * first, size, "from", first);
        const auto ends = require_points(to + 3 * first, size, "to", first);
        for (std::size_t i = 0; i < size; ++i) {
            segments[i] = {begins[i], ends[i]};
        }
        ask(std::span<const geometry::Segment>(segments).first(size), first);
    }
}

}  // namespace earshot::capi
