// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/simplification_report.h"

#include <string>

namespace earshot::cli {

/// The report of `earshot simplify` as text: what is left, how far it is from the original, what
/// became of materials and objects, and what changed for sound.
std::string simplify_text(const io::SimplificationReportParts& parts);

}  // namespace earshot::cli
