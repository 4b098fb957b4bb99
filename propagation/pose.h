// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>

namespace earshot::propagation {

/// Where a source or a listener is and looks: unit vectors at right angles, left = up x front.
struct Pose {
    geometry::Vec3 position{0.0};
    geometry::Vec3 front{0.0, 0.0, -1.0};
    geometry::Vec3 left{-1.0, 0.0, 0.0};
    geometry::Vec3 up{0.0, 1.0, 0.0};

    /// Front, left, up components of a direction of the scene.
    geometry::Vec3 seen_from(const geometry::Vec3& direction) const {
        return {glm::dot(direction, front), glm::dot(direction, left), glm::dot(direction, up)};
    }
};

/// Looking along `front`, `up` as much above as that allows; of any length. What has no direction
/// is replaced by the scene's axes.
Pose pose_towards(const geometry::Vec3& position,
                  const geometry::Vec3& front,
                  const geometry::Vec3& up);

}  // namespace earshot::propagation
