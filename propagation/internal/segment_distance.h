// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace earshot::propagation {

/// Metres from a point to the closest one of a segment, which may be a point itself.
inline double distance_to_segment(const geometry::Vec3& point,
                                  const std::array<geometry::Vec3, 2>& segment) {
    const geometry::Vec3 along = segment[1] - segment[0];
    const double squared = glm::dot(along, along);
    const double u =
        squared > 0.0 ? std::clamp(glm::dot(point - segment[0], along) / squared, 0.0, 1.0) : 0.0;
    return glm::distance(point, segment[0] + u * along);
}

}  // namespace earshot::propagation
