// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/topology.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// A triangle soup as a set of orientable manifold patches with border.
struct ManifoldFans {
    /// The triangles with one vertex per fan: a run of triangles around a vertex, each a neighbour
    /// of the next. All triangles of a patch have the same winding.
    std::vector<Triangle> triangles;
    std::size_t vertex_count = 0;               ///< of fans
    std::vector<bool> is_flipped;               ///< per triangle: its corners 1 and 2 are swapped
    std::vector<std::uint32_t> patch;           ///< per triangle, in the order of first triangles
    std::vector<bool> is_patch_orientable;      ///< per patch
    std::vector<std::uint32_t> uses_of_border;  ///< per half-edge of `triangles`: how many
                                                ///< triangles meet there; 0 where it has a twin
};

/// Joins the triangles of an edge in pairs: the two of an edge of two; of more, greedily, those of
/// opposite direction that are closest to one plane. Then turns each triangle to the winding of the
/// larger part of its patch, by area. Where that is impossible (a Moebius strip) the edge between
/// two triangles that disagree is split. Precondition: welded triangles that have an area.
ManifoldFans split_fans(std::span<const Triangle> triangles, std::span<const Vec3> positions);

}  // namespace earshot::geometry
