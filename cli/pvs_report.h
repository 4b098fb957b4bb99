// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/visible_sets.h"

#include <optional>
#include <string>

namespace earshot::cli {

/// What a file of visible sets holds, as lines or as JSON. `seconds`: what making it took, if
/// it was made.
std::string pvs_summary(const visibility::VisibleSets& sets,
                        const std::string& file,
                        std::optional<double> seconds,
                        bool as_json);

/// The cells that see the most triangles, the largest first, and what fewer cells would cost.
std::string pvs_tables(const visibility::VisibleSets& sets);

}  // namespace earshot::cli
