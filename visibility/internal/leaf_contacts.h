// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/view_cells.h"

#include <vector>

namespace earshot::visibility {

/// Two leaves with a common patch of face.
struct LeafContact {
    LeafId first = 0, second = 0;  ///< first < second
    double area = 0.0;             ///< square metres
    friend bool operator==(const LeafContact&, const LeafContact&) = default;
};

/// Every pair once, ascending. Leaves that touch in edges or corners only are no neighbours.
std::vector<LeafContact> leaf_contacts(const ViewCells& cells);

}  // namespace earshot::visibility
