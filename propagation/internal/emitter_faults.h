// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/internal/separation.h"
#include "earshot/propagation/model_check.h"
#include "earshot/visibility/reached_sides.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A source or a listener with its place.
struct PlacedEmitter {
    bool is_source = false;
    std::size_t index = 0;
    geometry::Vec3 position{0.0};
};

/// Sources, then listeners, of a scene at an instant.
std::vector<PlacedEmitter> placed_emitters(const Scene& scene, double time);

/// What is known of emitters' surroundings.
struct EmitterSurroundings {
    const visibility::ReachedSides& reached;
    std::span<const std::optional<Separation::Enclosure>> enclosures;  ///< one per emitter
    std::span<const geometry::Island> surfaces;                        ///< that enclosures number
    const SceneExtent& extent;
};

/// Emitters in solids, outside, or in an air without a counterpart, in their order.
std::vector<MisplacedEmitter> find_misplaced(std::span<const PlacedEmitter> emitters,
                                             const EmitterSurroundings& surroundings);

}  // namespace earshot::propagation
