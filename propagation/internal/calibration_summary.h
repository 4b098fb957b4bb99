// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/calibration.h"

namespace earshot::propagation {

/// The multiple of `step` that is closest.
double rounded_to(double step, double value) noexcept;

/// Fills in what the residuals amount to per band, and the warnings. `scene`: for the names of
/// materials.
void summarize(const Scene& scene, const audio::Bands& bands, CalibrationResult& result);

}  // namespace earshot::propagation
