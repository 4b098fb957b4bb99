// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/internal/moving_scene.h"

#include <span>

namespace earshot::collision {

/// False only if the loop of straight edges through these vertices, seen along a unit vector, does
/// not meet itself at any time of the step. Precondition: at least three vertices, all different.
bool meets_itself(const MovingScene& scene,
                  std::span<const geometry::VertexId> loop,
                  const geometry::Vec3& direction);

}  // namespace earshot::collision
