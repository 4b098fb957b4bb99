// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <algorithm>
#include <cstdint>
#include <functional>

namespace earshot::collision {

struct ContactOptions {
    bool between_meshes = true;
    bool within_meshes = false;  ///< self-collision
    /// Which pairs of meshes (a <= b) are tested; empty: all. Must not change during a call.
    std::function<bool(std::uint32_t a, std::uint32_t b)> filter{};
    /// Elements this close along every axis are in contact, metres; 0: exact contact.
    double min_separation = 0.0;
    double tolerance = 1e-6;  ///< metres, with min_separation

    // Culling methods; contacts are the same without them.

    /// Traversals begin at the front of the bounding-volume test tree where the last one ended.
    bool track_front = true;
    /// Nodes that pass the continuous normal cone and contour tests are not tested against
    /// themselves; only without a minimum separation.
    bool cull_with_normal_cones = true;
    /// Every vertex and edge is tested with its representative triangle only.
    bool assign_representatives = true;

    /// Whether contacts of two meshes are asked for.
    bool accepts(std::uint32_t a, std::uint32_t b) const {
        return (a == b ? within_meshes : between_meshes) &&
               (!filter || filter(std::min(a, b), std::max(a, b)));
    }

    /// How far bounding volumes are padded so that no contact is missed, metres.
    double margin() const noexcept {
        return min_separation > 0.0 ? min_separation + 2.0 * tolerance : 0.0;
    }
};

}  // namespace earshot::collision
