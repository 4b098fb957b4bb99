// SPDX-License-Identifier: MIT
#include "earshot/bvh/update_statistics.h"

namespace earshot::bvh {

UpdateStatistics& UpdateStatistics::operator+=(const UpdateStatistics& other) noexcept {
    refits += other.refits;
    repairs += other.repairs;
    rebuilds += other.rebuilds;
    return *this;
}

void UpdateStatistics::count(UpdateAction action) noexcept {
    refits += action == UpdateAction::refit ? 1 : 0;
    repairs += action == UpdateAction::repair ? 1 : 0;
    rebuilds += action == UpdateAction::rebuild ? 1 : 0;
}

}  // namespace earshot::bvh
