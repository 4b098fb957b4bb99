// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"

namespace earshot::frustum {

/// Whether a facet may send what is in the frustum on to a listener: a superset of the true last
/// reflections, decided by the point in which it would reflect, which must lie in the facet's box
/// and in the frustum; what stands in the way is left to the verification. `moved`: metres, as far
/// as PathVerifier takes rounding to reach, and more.
bool may_reflect_last(const FacetIndex& index,
                      const Frustum& frustum,
                      geometry::FacetId facet,
                      const geometry::Vec3& listener,
                      double moved) noexcept;

}  // namespace earshot::frustum
