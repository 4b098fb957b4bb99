// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/response_job.h"

#include <nlohmann/json.hpp>

#include <string>

namespace earshot::cli {

/// What `earshot ir --sensitivity` tells at its end of each material: area, share of the energy
/// that it absorbs before and after 80 ms, change of T30, C80 and STI by its absorption; means over
/// the pairs and over 500 Hz and 1 kHz, the materials that change T30 most first. Empty unless
/// Options::report_materials.
std::string sensitivity_text(const ResponseJob& job, const ResponseSummary& summary);

/// The same for a program: `sensitivity` of the summary, in the order of the scene.
nlohmann::ordered_json sensitivity_json(const ResponseJob& job, const ResponseSummary& summary);

}  // namespace earshot::cli
