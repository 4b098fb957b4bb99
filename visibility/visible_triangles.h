// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <cstdint>
#include <vector>

namespace earshot::visibility {

// Which triangles a point sees. Each one that is reported is proved by a direction in which
// bvh::closest_hit() is that triangle: the set is a part of the true one, never more (it is
// "aggressive"). What it may lack, and why that is little, is told in
// docs/algorithms/visibility.md. Both sides of a triangle are seen. A point on a triangle sees that
// triangle and nothing else but what lies in its plane; one that is not finite, or in an empty
// mesh, sees nothing.

struct VisibleOptions {
    /// The coarsest and the finest resolution that can be asked for, radians.
    static constexpr double kCoarsest = 0.2;
    static constexpr double kFinest = 1e-4;

    /// Angle between neighbouring rays of the sweep where they are farthest apart, radians; the
    /// sweep takes about 24 / resolution^2 of them. Precondition: kFinest ... kCoarsest.
    double resolution = math::kPi / 360.0;
    /// Whether to look for what the sweep has missed.
    bool is_refined = true;
    /// Between two directions in which different things are seen more is looked for down to this
    /// angle, radians. Precondition: positive.
    double least_gap = 1e-5;
    /// The corners of each triangle that is found are looked past at this angle, radians.
    /// Precondition: positive.
    double border = 1e-6;
    /// How many rays may be spent on what the sweep has missed.
    std::uint64_t most_refining_rays = std::uint64_t{1} << 32U;
};

struct VisibleTriangle {
    geometry::TriangleId triangle = 0;
    /// Unit vector: in this direction it is the closest hit.
    geometry::Vec3 direction{};
    std::uint64_t pixels = 0;  ///< rays of the sweep that hit it first; 0: found later
    double solid_angle = 0.0;  ///< of these pixels together, steradians
    friend bool operator==(const VisibleTriangle&, const VisibleTriangle&) = default;
};

struct VisibleTriangles {
    std::vector<VisibleTriangle> triangles;  ///< by ascending TriangleId
    double free_solid_angle = 0.0;           ///< where the sweep hits nothing, steradians
    std::uint64_t rays = 0;                  ///< that were cast
    bool is_complete = true;                 ///< false: `most_refining_rays` were not enough
    friend bool operator==(const VisibleTriangles&, const VisibleTriangles&) = default;
};

/// What is seen from `point`. First a sweep: rays through the pixels of the six faces of a cube
/// around it (an item buffer). Then, unless told otherwise, what lies between pixels: gaps between
/// neighbours that see different things are halved, the border of every triangle found is followed
/// (adaptive border sampling; Wonka et al. 2006), and each triangle that is still missing is aimed
/// at, so that every one whose middle is seen is found. The same for any tree and executor.
/// Precondition: the tree was built over or refitted to this mesh.
VisibleTriangles visible_triangles(const bvh::WideTree& tree,
                                   const geometry::MeshView& mesh,
                                   const geometry::Vec3& point,
                                   const VisibleOptions& options = {},
                                   Executor& executor = Executor::serial(),
                                   Progress* progress = nullptr);

}  // namespace earshot::visibility
