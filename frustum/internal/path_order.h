// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/trace.h"

namespace earshot::frustum {

/// Sorts paths by listener, length, order and triangles, and leaves one of those that are the same
/// way through space (a bounce on an edge shared by two facets): the one with the lowest triangle
/// list. `scale`: largest coordinate of the scene, metres.
void sort_and_unify(std::vector<SpecularPath>& paths, double scale);

}  // namespace earshot::frustum
