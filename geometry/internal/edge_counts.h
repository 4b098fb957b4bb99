// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/clean.h"

#include <span>

namespace earshot::geometry {

/// Sets the counts of edges, holes and T-junctions. Precondition: the triangles are welded, and
/// each has an area.
void count_edges(std::span<const Triangle> triangles,
                 std::span<const Vec3> positions,
                 CleanReport& report);

}  // namespace earshot::geometry
