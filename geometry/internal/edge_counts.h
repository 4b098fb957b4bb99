// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/clean.h"

#include <span>

namespace earshot::geometry {

/// Sets the counts of edges, holes and T-junctions. `triangles` are welded and without area none.
void count_edges(std::span<const Triangle> triangles,
                 std::span<const Vec3> positions,
                 CleanReport& report);

}  // namespace earshot::geometry
