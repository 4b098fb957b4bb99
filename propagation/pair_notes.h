// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <span>
#include <string>

namespace earshot::propagation {

/// One note on the pairs of a simulation without diffraction that have no direct path, where sound
/// that bends round edges would arrive first. Nothing if all have one. Pairs that were simulated
/// without Options::report_paths are not told of. `scene` has the names.
Warnings note_blocked_pairs(const Scene& scene, std::span<const PairResult> pairs);

/// Notes on the pair of that name: that it has no sound, and that the rays did not suffice for the
/// error that was asked for.
Warnings note_sound(const PairResult& pair, const std::string& name);

}  // namespace earshot::propagation
