// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/planar_regions.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

struct SimplifyOptions {
    /// Metres. Of samples of the surface: vertices and points within edges. Measure what came of it
    /// (bvh/surface_distance.h) before it is called a bound.
    double max_distance = 0.01;
    /// Radians, 0 ... pi: the opening of the cone that holds the normals of a triangle and of all
    /// that it replaces.
    double max_angle = 3.141592653589793;
    /// Of the triangles that are made: no longer in proportion to their height, unless those before
    /// were. Slivers have no normal to speak of.
    double max_aspect_ratio = 200.0;
    /// Move vertices that are left onto the planes of large facets, so that what was rounded
    /// becomes sharp and flat walls stay flat. Off: vertices stay where they are or vanish.
    bool sharpen = true;
    /// Samples within an edge, besides its ends. More follow coarse meshes more closely.
    int samples_per_edge = 3;
};

/// Throws Error if an option is out of range.
void validate(const SimplifyOptions& options);

/// Whether this build has the library (OpenMesh) that simplify() needs.
bool simplify_available() noexcept;

/// Fewer triangles for the same surface. First coplanar regions are triangulated anew
/// (merge_planar_regions()), then half-edges collapse in the order of their quadric errors (Garland
/// and Heckbert 1997). Labels stay: the lines between two of them, borders, and the places where
/// more than two triangles meet keep within the distance of what they were, and closed surfaces
/// stay closed. Duplicate and degenerate triangles are left out as clean() finds them. The result
/// depends on mesh, labels and options alone. Throws Error unless simplify_available() or if an
/// option is out of range. Preconditions as for clean(); labels.size() == triangles.size().
SimplifiedMesh simplify(const MeshView& mesh,
                        std::span<const std::uint32_t> labels,
                        const SimplifyOptions& options = {},
                        Executor& executor = Executor::serial());

}  // namespace earshot::geometry
