// SPDX-License-Identifier: MIT
#include "collision_contenders.h"

namespace bench {

std::unique_ptr<DiscreteContender> coal_contender() {
    return nullptr;
}

}  // namespace bench
