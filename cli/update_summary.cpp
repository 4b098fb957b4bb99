// SPDX-License-Identifier: MIT
#include "earshot/cli/update_summary.h"

namespace earshot::cli {

std::string update_text(const bvh::UpdateStatistics& updates) {
    return std::to_string(updates.refits) + " refits, " + std::to_string(updates.repairs) +
           " repairs, " + std::to_string(updates.rebuilds) + " rebuilds";
}

nlohmann::ordered_json update_json(const bvh::UpdateStatistics& updates) {
    return {
        {"refits", updates.refits}, {"repairs", updates.repairs}, {"rebuilds", updates.rebuilds}};
}

}  // namespace earshot::cli
