// SPDX-License-Identifier: MIT
#include "earshot/collision/statistics.h"

namespace earshot::collision {

WorldStatistics& WorldStatistics::operator+=(const WorldStatistics& other) noexcept {
    box_tests += other.box_tests;
    triangle_pairs += other.triangle_pairs;
    elementary_tests += other.elementary_tests;
    front_nodes += other.front_nodes;
    updates += other.updates;
    return *this;
}

}  // namespace earshot::collision
