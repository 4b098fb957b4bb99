// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/view_cells.h"

#include <vector>

namespace earshot::visibility {

/// Two leaves that share a patch of a face.
struct CellAdjacency {
    LeafId first = 0, second = 0;  ///< first < second
    double area = 0.0;             ///< square metres
    friend bool operator==(const CellAdjacency&, const CellAdjacency&) = default;
};

/// All adjacent pairs of leaves, each once, ascending. Leaves that touch in edges or corners only
/// are not adjacent.
std::vector<CellAdjacency> cell_adjacencies(const ViewCells& cells);

}  // namespace earshot::visibility
