// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/update_statistics.h"

#include <nlohmann/json.hpp>

#include <string>

namespace earshot::cli {

/// "3 refits, 1 repairs, 0 rebuilds".
std::string update_text(const bvh::UpdateStatistics& updates);

/// The object "hierarchy" of summaries: the same, by name.
nlohmann::ordered_json update_json(const bvh::UpdateStatistics& updates);

}  // namespace earshot::cli
