// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/response_job.h"

#include <string>

namespace earshot::cli {

/// What `earshot ir` prints at its end for a person: scene, clean-up, paths per order, times,
/// files, metrics of the pairs.
std::string summary_text(const ResponseJob& job, const ResponseSummary& summary);

/// The same as a JSON object for a program (`--json`).
std::string summary_json(const ResponseJob& job, const ResponseSummary& summary);

}  // namespace earshot::cli
