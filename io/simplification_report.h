// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/model_comparison.h"
#include "earshot/propagation/model_simplification.h"

#include <string>

namespace earshot::io {

/// A report with what it refers to.
struct SimplificationReportParts {
    const propagation::SimplifiedModel& model;
    propagation::SimplificationOptions options;
    const propagation::ModelComparison* comparison = nullptr;  ///< if the models were compared
    double seconds = 0.0;                                      ///< that simplifying took
};

/// JSON as `earshot simplify --json` prints it; docs/files.md describes its keys. But for the
/// seconds the same bytes for the same report.
std::string encode_simplification_report(const SimplificationReportParts& parts);

}  // namespace earshot::io
