// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/internal/scene_geometry.h"
#include "earshot/visibility/visible_sets.h"

#include <cstdint>
#include <vector>

namespace earshot::propagation {

/// Per facet: 1 if the cell of the source sees a triangle of it, so that it may reflect first.
/// Empty where every facet may: without sets (null), and for a source outside of their region.
std::vector<std::uint8_t> first_facets(const visibility::VisibleSets* sets,
                                       const SceneGeometry& geometry,
                                       const geometry::Vec3& source,
                                       Executor& executor);

}  // namespace earshot::propagation
