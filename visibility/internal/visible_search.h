// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/visible_triangles.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A direction and the triangle that is seen in it.
struct Look {
    geometry::Vec3 direction{};
    geometry::TriangleId triangle = kNoTriangle;
};

/// Two directions between which more may be seen.
struct Gap {
    Look first, second;
};

/// The triangles found so far from one point, and the ways to find more.
class VisibleSearch {
public:
    VisibleSearch(const bvh::WideTree& tree,
                  const geometry::MeshView& mesh,
                  const geometry::Vec3& point,
                  const VisibleTrianglesOptions& options,
                  Executor& executor);

    /// Casts a ray in every direction and notes what is new, in order.
    std::vector<geometry::TriangleId> look(std::span<const geometry::Vec3> directions);

    /// A pixel in which `triangle`, or nothing, was seen.
    void count_pixel(geometry::TriangleId triangle, double solid_angle);

    /// Whether there may be more to be seen in the middle of a gap: both ends see different things
    /// that are not joined by an edge, or they are farther apart than `longest`; and they are
    /// farther apart than the least gap.
    bool is_open(const Gap& gap, double longest) const noexcept;

    /// Halves open gaps until none is left.
    void narrow(std::vector<Gap> gaps, double longest = std::numeric_limits<double>::infinity());

    /// Follows the borders of the triangles found, those included that are found by it.
    void follow_borders(Progress* progress);

    /// Looks towards the middle of every triangle that has not been found.
    void aim_at_others(Progress* progress);

    /// What was found; to be called once, at the end.
    VisibleTriangles finish();

private:
    /// look(), but returns nothing if that would be too many rays.
    std::optional<std::vector<geometry::TriangleId>> refine(
        std::span<const geometry::Vec3> directions);
    void note(geometry::TriangleId triangle, const geometry::Vec3& direction);
    bool are_joined(geometry::TriangleId a, geometry::TriangleId b) const noexcept;
    std::array<geometry::Vec3, 3> corners_of(geometry::TriangleId triangle) const noexcept;

    const bvh::WideTree& tree_;
    const geometry::MeshView mesh_;
    const geometry::Vec3 point_;
    const VisibleTrianglesOptions options_;
    Executor& executor_;
    std::vector<std::uint32_t> place_;  // of each triangle in found_.triangles, or kNoTriangle
    VisibleTriangles found_;            // in the order of discovery
    std::size_t followed_ = 0;          // so many of these have been
    std::uint64_t refining_rays_ = 0;
};

}  // namespace earshot::visibility
