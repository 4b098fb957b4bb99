// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/energy_histogram.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/pair_result.h"

namespace earshot::propagation {

/// Multiplies the pressures of a path by what the source sends into its first leg.
void radiate(const RaySource& source, const audio::Bands& bands, Path& path);

/// Whether no energy arrives in any band.
bool is_silent(const audio::EnergyHistogram& histogram);

}  // namespace earshot::propagation
