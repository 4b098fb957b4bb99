// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <cstdint>
#include <vector>

namespace earshot::frustum {

/// Coincident layers are facets that lie closer to each other than the rounding of what made them:
/// a poster in the plane of a wall, a carpet on a floor, a wall that an export holds twice. They
/// act as one surface: no path fits between them, and of those at one place the triangle with the
/// lowest number counts.

/// Planes this close to parallel, as the sine of their angle, may be layers of one surface.
inline constexpr double kMaxLayerTilt = 0x1p-10;

/// Metres: points of layers of one surface lie this close to each other's planes.
double max_layer_distance(const geometry::Facets& facets,
                          const geometry::Facet& a,
                          const geometry::Facet& b) noexcept;

/// Whether two facets are layers of one surface where a path meets them.
bool are_coincident_at(const geometry::Facets& facets,
                       const geometry::Facet& a,
                       const geometry::Vec3& on_a,
                       const geometry::Facet& b,
                       const geometry::Vec3& on_b) noexcept;

/// Whether all of a triangle of `facet` lies in the plane of `surface`, as far as the
/// single-precision coordinates of files can tell.
bool is_coincident_layer(const SceneView& scene,
                         const geometry::Facet& surface,
                         geometry::TriangleId triangle) noexcept;

/// Per facet: 1 if it is not transmissive and a transmissive layer with a lower triangle number may
/// coincide with it. Empty if no facet of the scene is transmissive.
std::vector<std::uint8_t> find_transmissive_layers(const SceneView& scene);

}  // namespace earshot::frustum
