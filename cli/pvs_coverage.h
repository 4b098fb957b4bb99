// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/visible_sets.h"

#include <span>
#include <string>

namespace earshot::cli {

/// A warning for each source that lies outside of the region of the visible sets at some instant:
/// the sets then leave out none of its paths.
Warnings uncovered_sources(const propagation::Scene& scene,
                           const visibility::VisibleSets& sets,
                           const std::string& sets_file,
                           std::span<const double> instants);

}  // namespace earshot::cli
