// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/model_check.h"
#include "earshot/propagation/model_findings.h"
#include "earshot/propagation/model_mending.h"

#include <cstdint>
#include <span>
#include <string>

namespace earshot::io {

/// A report with what it refers to.
struct ModelReportParts {
    const propagation::Scene& scene;
    const propagation::ModelReport& report;
    std::span<const propagation::Finding> findings;
    std::string unit = "m";                               ///< the file was read in
    const propagation::MendingReport* mending = nullptr;  ///< if a mended copy was made
};

/// JSON as `earshot check --json` prints it; docs/files.md describes its keys. The same bytes for
/// the same report.
std::string encode_model_report(const ModelReportParts& parts);

}  // namespace earshot::io
