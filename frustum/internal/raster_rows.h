// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>

namespace earshot::frustum {

/// What edges of polygons have marked in a grid of up to eight rows and columns, a word per row.
struct alignas(64) RasterRows {
    static constexpr std::size_t kCount = 8;

    std::uint64_t boundary[kCount] = {};  ///< bit k: an edge may pass column k
    /// Bytes: by how much the winding number changes from the column before, edges that go up and
    /// edges that go down.
    std::uint64_t up[kCount] = {}, down[kCount] = {};
};

/// The points (u, v) of a grid of n x n cells in cells: (point - lower) * scale.
struct RasterGrid {
    double lower[2], scale[2];
    double cells;  ///< n
    double slack;  ///< in cells
};

/// Marks every cell within slack of `count` edges of a closed loop, from that of vertex `first` to
/// the next one on, and counts each edge for every cell centre to the right of where it crosses the
/// centre's row. `vertices`: pairs, `size` of them. `only_centres`: the boundary is not wanted.
/// Precondition: bytes can count so many edges more. The same bits on every instruction set.
void add_edges(const RasterGrid& grid,
               const double* vertices,
               std::size_t size,
               std::size_t first,
               std::size_t count,
               bool only_centres,
               RasterRows& rows) noexcept;

}  // namespace earshot::frustum
