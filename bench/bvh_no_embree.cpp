// SPDX-License-Identifier: MIT
#include "bvh_contenders.h"

namespace bench {

std::vector<std::unique_ptr<Contender>> embree_contenders(int, const std::string&) {
    return {};
}

}  // namespace bench
