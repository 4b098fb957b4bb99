// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/paths.h"
#include "earshot/geometry/facets.h"

namespace earshot::frustum {

/// Sorts paths by listener, length, order and triangles, and leaves one of those that are the same
/// way through space: a bounce on an edge shared by two facets, or on surfaces within the facets'
/// tolerance of each other (a carpet on a floor; in a turned room rounding tells their planes
/// apart). The one with the lowest triangle list stays. `scale`: largest coordinate of the scene,
/// metres.
void sort_and_unify(std::vector<SpecularPath>& paths, const geometry::Facets& facets, double scale);

}  // namespace earshot::frustum
