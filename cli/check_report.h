// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/model_report.h"

#include <string>

namespace earshot::cli {

/// The report of `earshot check` as text: the verdict, a line per finding, then figures.
std::string check_text(const io::ModelReportParts& parts);

/// 0 clean, 1 unusable, 3 questionable.
int check_status(propagation::Severity severity);

}  // namespace earshot::cli
