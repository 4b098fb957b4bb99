// SPDX-License-Identifier: MIT
#include "earshot/collision/statistics.h"

namespace earshot::collision {

WorldStatistics& WorldStatistics::operator+=(const WorldStatistics& other) noexcept {
    box_tests += other.box_tests;
    triangle_pairs += other.triangle_pairs;
    elementary_tests += other.elementary_tests;
    refits += other.refits;
    repairs += other.repairs;
    rebuilds += other.rebuilds;
    return *this;
}

void WorldStatistics::count(bvh::UpdateAction action) noexcept {
    refits += action == bvh::UpdateAction::refit ? 1 : 0;
    repairs += action == bvh::UpdateAction::repair ? 1 : 0;
    rebuilds += action == bvh::UpdateAction::rebuild ? 1 : 0;
}

}  // namespace earshot::collision
