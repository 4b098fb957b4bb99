// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/layer_overlaps.h"
#include "earshot/geometry/facets.h"
#include "earshot/propagation/internal/checked_mesh.h"
#include "earshot/visibility/triangle_sides.h"

#include <functional>
#include <vector>

namespace earshot::propagation {

/// Places where two triangles of the checked mesh lie in one plane, cut otherwise than each other,
/// and one of them faces the air: doubled faces, unlike a solid that stands on a floor, whose
/// underside faces none. `is_air` tells a side.
std::vector<frustum::LayerOverlap> find_exposed_layers(
    const CheckedMesh& mesh,
    const geometry::Facets& facets,
    const std::function<bool(visibility::SideId)>& is_air);

}  // namespace earshot::propagation
