// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/calibration.h"

#include <string>

namespace earshot::cli {

/// A calibration as text: the residuals, a row per material, and what the data do not tell apart.
std::string calibration_text(const io::CalibrationParts& parts);

}  // namespace earshot::cli
