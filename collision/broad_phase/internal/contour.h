// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/internal/moving_scene.h"

#include <span>

namespace earshot::collision {

/// The contour test: false only if the closed polygon through these vertices, projected along a
/// unit vector, does not intersect itself at any time of the step. Precondition: at least three
/// vertices, all different.
bool contour_self_intersects(const MovingScene& scene,
                             std::span<const geometry::VertexId> loop,
                             const geometry::Vec3& direction);

}  // namespace earshot::collision
