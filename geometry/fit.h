// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <span>

namespace earshot::geometry {

// Planes, axes and boxes of groups of triangles, such as a facet, a chair or a mesh. Areas are
// weighted exactly, so that the result does not depend on how a surface is cut into triangles but
// for rounding. Results are rounded to 2^-26 of the largest coordinate difference (directions: to
// 2^-26), which is far coarser than the rounding of the sums. Triangles without area carry no
// weight. Precondition of all: at least one triangle, indices in range, positions finite.

/// The mean of a surface and the directions in which it extends most.
struct PrincipalAxes {
    Vec3 centroid{0.0};        ///< of the area
    double area = 0.0;         ///< square metres
    std::array<Vec3, 3> axes;  ///< unit vectors, right-handed, by descending deviation
    Vec3 deviations{0.0};      ///< standard deviations of the area along the axes, metres
};

/// By the second moments of the area (principal component analysis, Pearson 1901). The largest
/// component of the first two axes is positive. Where deviations are equal the axes are any in
/// their plane, or any at all. Triangles without any area count by their corners.
PrincipalAxes fit_axes(const MeshView& mesh, std::span<const TriangleId> triangles);

/// A plane through a surface, and how far that is from it.
struct PlaneFit {
    Plane plane;
    double rms_distance = 0.0;  ///< of the area, metres
    double max_distance = 0.0;  ///< of a vertex, metres
};

/// The plane of least squared distance from the area, through its centroid. The normal points to
/// the side that most of the area faces; where the sides are equal its largest component is
/// positive.
PlaneFit fit_plane(const MeshView& mesh, std::span<const TriangleId> triangles);

/// A box that is turned: the corners are centre +- half_size[0] axes[0] +- ...
struct OrientedBox {
    Vec3 centre{0.0};
    std::array<Vec3, 3> axes;  ///< unit vectors, right-handed
    Vec3 half_size{0.0};       ///< along the axes, descending, metres

    double volume() const noexcept { return 8.0 * half_size.x * half_size.y * half_size.z; }
};

/// A small box around the triangles: the smallest by volume, then by surface, of those along the
/// coordinate axes, the principal axes, and the normals of the eight largest directions that the
/// surface faces, in pairs. Of a box, however it is turned and cut, it is that box; in general it
/// is not the smallest of all boxes.
OrientedBox fit_box(const MeshView& mesh, std::span<const TriangleId> triangles);

}  // namespace earshot::geometry
