// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/geometry/mesh.h"

namespace earshot::collision {

/// Whether two triangles of one mesh meet in more than what they share, as find_self_contacts()
/// defines it. Exact.
bool intersect_beyond_shared_features(const geometry::Triangle& one_ids,
                                      const Corners& one,
                                      const geometry::Triangle& other_ids,
                                      const Corners& other) noexcept;

}  // namespace earshot::collision
