// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/cell_leaf.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace earshot::visibility {

Reach::Reach(const Sight& sight,
             const SightPiece& piece,
             const geometry::Vec3& normal,
             double slack) {
    at_begin = glm::dot(normal, sight.from + piece.begin * sight.step);
    at_end = glm::dot(normal, sight.from + piece.end * sight.step);
    low = std::min(at_begin, at_end);
    high = std::max(at_begin, at_end);
    first = std::min(low + slack, high - slack);
    last = std::max(low + slack, high - slack);
}

}  // namespace earshot::visibility
