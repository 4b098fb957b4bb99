// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/line_of_sight.h"

#include <functional>
#include <limits>

namespace earshot::visibility {

// Point-to-point visibility from every point of one set to every point of another, by the rules of
// line_of_sight.h: a matrix with a row per `from` point and a column per `to` point. Rows are
// handed over one at a time, in order and on the calling thread, so that a matrix may be larger
// than memory: only a few rows, or about 2^18 pairs, are held at a time.

/// The cell of a pair that is mutually visible.
inline constexpr geometry::TriangleId kNoBlocker = std::numeric_limits<geometry::TriangleId>::max();

/// The points of a matrix's rows and columns. Precondition: fewer than 2^32 points to a set.
struct PointSets {
    std::span<const geometry::Vec3> from{};
    std::span<const geometry::Vec3> to{};
};

/// Hands over visible() of every pair, 1 or 0.
void visibility_matrix(const bvh::MeshBvh& bvh,
                       const PointSets& points,
                       const ExclusionMask& excluded,
                       Executor& executor,
                       const std::function<void(std::span<const std::uint8_t>)>& take_row);

/// Hands over the triangle of first_blocker() of every pair, or kNoBlocker.
void blocker_matrix(const bvh::MeshBvh& bvh,
                    const PointSets& points,
                    const ExclusionMask& excluded,
                    Executor& executor,
                    const std::function<void(std::span<const geometry::TriangleId>)>& take_row);

}  // namespace earshot::visibility
