// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/response_job.h"

#include <nlohmann/json.hpp>

#include <string>

namespace earshot::cli {

/// What `earshot ir` tells of the room and of each pair at its end: T30, EDT, C50, C80, each the
/// mean of 500 Hz and 1 kHz, and STI, with standard errors, and why one is missing; beside them
/// Sabine's and Eyring's times. Empty without metrics.
std::string pair_metrics_text(const ResponseJob& job, const ResponseSummary& summary);

/// The same for a program: `room` and `metrics` of the summary. An empty object without metrics.
nlohmann::ordered_json pair_metrics_json(const ResponseJob& job, const ResponseSummary& summary);

}  // namespace earshot::cli
