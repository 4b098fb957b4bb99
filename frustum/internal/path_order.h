// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/paths.h"
#include "earshot/geometry/facets.h"

#include <vector>

namespace earshot::frustum {

/// Sorts paths by listener, length, order and triangles, and leaves one of those that are the same
/// polyline in space: a reflection in an edge shared by two facets, or on coincident layers, which
/// are surfaces within the facets' tolerance of each other (a carpet on a floor; in a rotated room
/// rounding separates their planes). The one with the lowest triangle list stays. `extent`: largest
/// absolute coordinate of the scene, metres.
void sort_and_deduplicate(std::vector<SpecularPath>& paths,
                          const geometry::Facets& facets,
                          double extent);

}  // namespace earshot::frustum
