// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/internal/border_sampling.h"
#include "earshot/visibility/visible_triangle_set.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A direction and the triangle that is visible in it, or kNoTriangle.
struct DirectionSample {
    geometry::Vec3 direction{};
    geometry::TriangleId triangle = kNoTriangle;
};

/// Two neighbouring directions between which other triangles may be visible.
struct DirectionInterval {
    DirectionSample first, second;
};

/// The triangles found so far from one point, and the strategies that find more.
class VisibleSearch {
public:
    VisibleSearch(const bvh::MeshBvh& bvh,
                  const geometry::Vec3& point,
                  const VisibleTrianglesOptions& options,
                  Executor& executor);

    /// Casts a ray in every direction and records new triangles, in order. Returns the triangle of
    /// each direction, or kNoTriangle.
    std::vector<geometry::TriangleId> cast(std::span<const geometry::Vec3> directions);

    /// Counts a pixel of the item buffer that shows `triangle`, or kNoTriangle.
    void count_pixel(geometry::TriangleId triangle, double solid_angle);

    /// Whether an interval needs subdivision: its ends show different triangles that share no edge,
    /// or they are farther apart than `max_angle`; and they are farther apart than
    /// VisibleTrianglesOptions::min_gap.
    bool needs_subdivision(const DirectionInterval& interval, double max_angle) const noexcept;

    /// Bisects intervals until none needs subdivision.
    void subdivide(std::vector<DirectionInterval> intervals,
                   double max_angle = std::numeric_limits<double>::infinity());

    /// Adaptive border sampling of all triangles found, those included that it finds itself.
    void sample_borders(Progress* progress);

    /// Casts a ray towards the centroid of every triangle that has not been found.
    void aim_at_missing(Progress* progress);

    /// The result; to be called once, at the end.
    VisibleTriangles finish();

private:
    /// cast() within the limit of refining rays; empty if the rays would exceed it.
    std::optional<std::vector<geometry::TriangleId>> refine(
        std::span<const geometry::Vec3> directions);
    void record(geometry::TriangleId triangle, const geometry::Vec3& direction);
    bool share_edge(geometry::TriangleId a, geometry::TriangleId b) const noexcept;
    /// The corners of a triangle relative to the point.
    Corners relative_corners(geometry::TriangleId triangle) const noexcept;

    bvh::MeshBvh bvh_;
    const geometry::Vec3 point_;
    const VisibleTrianglesOptions options_;
    const ExclusionMask excluded_;  // triangles without area, too
    Executor& executor_;
    std::vector<std::uint32_t> index_of_triangle_;  // in found_.triangles, or kNoTriangle
    VisibleTriangles found_;                        // in the order of discovery
    std::size_t borders_followed_ = 0;              // so many triangles of found_
    std::uint64_t refining_rays_ = 0;
};

}  // namespace earshot::visibility
