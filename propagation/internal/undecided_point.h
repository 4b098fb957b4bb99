// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/propagation/scene.h"

namespace earshot::propagation {

/// What to say of a pair of which a point lies on a surface and its side is not known. `triangle`
/// is the surface's by the numbers of the scene.
Error undecided_point_error(const frustum::UndecidedPoint& point,
                            const Emitter& source,
                            const Emitter& listener,
                            geometry::TriangleId triangle);

}  // namespace earshot::propagation
