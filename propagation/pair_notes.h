// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <span>

namespace earshot::propagation {

/// One note on the pairs of a simulation without diffraction that have no direct path, where sound
/// that bends round edges would arrive first. Nothing if all have one. Pairs that were simulated
/// without Options::report_paths are not told of. `scene` has the names.
Warnings note_blocked_pairs(const Scene& scene, std::span<const PairResult> pairs);

}  // namespace earshot::propagation
