// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"
#include "earshot/propagation/simulator.h"

#include <vector>

namespace earshot::propagation {

/// Spectra such as paths of a scene may have: up to three surfaces of any of its materials, up to
/// several hundred metres of air, and what its sources radiate into some directions.
std::vector<audio::Spectrum> path_spectra(const Scene& scene, const Options& options);

}  // namespace earshot::propagation
