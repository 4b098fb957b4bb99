// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/internal/half_edge_mesh.h"

#include <span>
#include <vector>

namespace earshot::geometry {

/// A surface before decimation and its facets.
struct PlacementInput {
    MeshView mesh;
    const Facets& facets;               ///< of these triangles
    const std::vector<bool>& is_fixed;  ///< per vertex: stays
};

/// Moves vertices that decimation has left onto the planes of large facets that their triangles
/// stand for: to the corner where three of them meet, to the line of two, to one plane; no farther
/// than twice `max_distance`. What was rounded becomes sharp, and walls stay flat, so that they are
/// mirrors as before (planar proxies: Salinas, Lafarge and Alliez 2015). Facets count that are
/// wider than a few distances and face nearly as the triangle does. A vertex stays where a triangle
/// would turn over. Returns all positions.
std::vector<Vec3> place_on_planes(const PlacementInput& input,
                                  std::span<const DecimatedTriangle> triangles,
                                  double max_distance);

}  // namespace earshot::geometry
