// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Two triangles of different labels that claim one place: parts of coincident layers, which lie
/// closer to each other than the rounding of the scene's coordinates.
struct LayerOverlap {
    geometry::TriangleId first = 0;   ///< the lower number, which counts there
    geometry::TriangleId second = 0;  ///< the other
    double area = 0.0;                ///< square metres that both cover
    geometry::Vec3 point{0.0};        ///< in the middle of them
};

/// All pairs of triangles with different labels (one per triangle) that overlap, by first, then
/// second. Strips as narrow as a few roundings, where walls meet, are left out.
std::vector<LayerOverlap> find_layer_overlaps(const SceneView& scene,
                                              std::span<const std::uint32_t> labels);

}  // namespace earshot::frustum
