// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/free_segments.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::visibility {

/// The projection of a picture. Rows run from the top down, columns from left to right, +Y is up.
struct View {
    std::size_t width = 1024, height = 512;
    /// The view direction of a perspective picture, of any length but 0; straight down, -Z is at
    /// the top, and straight up +Z. Without it: a panorama of all directions, equal angles per
    /// pixel, -Z in the middle and +X to its right.
    std::optional<geometry::Vec3> forward{};
    /// Angle over the width of a perspective view, radians. Precondition: above 0, below pi.
    double field_of_view = math::kPi / 2.0;
    /// Width of a picture in parallel projection, metres: its rays start in the plane through the
    /// point, perpendicular to `forward`, and the field of view plays no part. Needs `forward`.
    std::optional<double> parallel_width{};
};

/// An item buffer (Weghorst et al. 1984): the triangle that is visible in each pixel of a picture,
/// row by row.
struct ItemBuffer {
    View view{};
    std::vector<geometry::Vec3> directions;       ///< unit vectors
    std::vector<geometry::TriangleId> triangles;  ///< or kNoTriangle
    std::vector<double> distances;  ///< metres along the ray; infinite where no triangle is
};

/// Casts one ray from `point` through the middle of every pixel, or from the middle of every pixel
/// of a parallel picture. Excluded triangles are treated as absent, and so are triangles without
/// area. Precondition: width and height are not 0, and the tree was built over or refitted to this
/// mesh.
ItemBuffer render_item_buffer(const bvh::MeshBvh& bvh,
                              const geometry::Vec3& point,
                              const View& view,
                              const ExclusionMask& excluded = {},
                              Executor& executor = Executor::serial(),
                              Progress* progress = nullptr);

}  // namespace earshot::visibility
