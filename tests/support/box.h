// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <vector>

namespace earshot::test {

/// The twelve triangles of a box, fronts outside. Bit k of a corner's number tells whether it is on
/// the upper side along axis k.
inline std::vector<geometry::Triangle> box_triangles() {
    return {{0, 2, 1},
            {1, 2, 3},
            {4, 5, 6},
            {5, 7, 6},
            {0, 1, 4},
            {1, 5, 4},
            {2, 6, 3},
            {3, 6, 7},
            {0, 4, 2},
            {2, 4, 6},
            {1, 3, 5},
            {3, 7, 5}};
}

}  // namespace earshot::test
