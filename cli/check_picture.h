// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/model_check.h"

#include <string>

namespace earshot::cli {

/// A plan and an elevation of a scene with what a check found in it, SVG: leaks as red discs, holes
/// that do not leak in orange, sources and listeners by name, misplaced ones in red.
std::string check_picture(const propagation::Scene& scene,
                          double time,
                          const propagation::ModelReport& report);

}  // namespace earshot::cli
