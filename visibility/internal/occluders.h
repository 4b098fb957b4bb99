// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/internal/viewer_region.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Triangles, and patches of triangles in about one plane that share their edges, which hide whole
/// boxes of points. What is hidden is decided with bounds of the rounding: a segment into a hidden
/// box touches one of the occluder's triangles by the exact test, too.
class Occluders {
public:
    using Id = std::uint32_t;

    /// Patches are made of the kMaxPatchedTriangles largest triangles that block.
    Occluders(const geometry::MeshView& mesh, const ExclusionMask& excluded);

    /// The triangle's patch, or, without one, the triangle. Precondition: it blocks.
    Id of_triangle(geometry::TriangleId triangle) const noexcept;

    /// Whether the occluder blocks every line of sight from the region to the box. Errs to the side
    /// of false. Precondition: a mesh with the triangles of the first, moved or not.
    bool hides(const geometry::MeshView& mesh,
               Id occluder,
               const ViewerRegion& viewer,
               const geometry::Aabb& box) const noexcept;

    bool has_moved(Id occluder, std::span<const std::uint8_t> moved) const noexcept;
    /// Patches that have moved are none any more.
    void remove_moved_patches(std::span<const std::uint8_t> moved);

    std::size_t patch_count() const noexcept { return patches_.size(); }

    static constexpr std::size_t kMaxPatchedTriangles = std::size_t{1} << 16U;
    static constexpr std::size_t kMaxPatchTriangles = 256;
    static constexpr std::size_t kMaxPatchEdges = 64;

private:
    using Edge = std::array<geometry::Vec3, 2>;

    struct Patch {
        geometry::Vec3 normal{0.0}, origin{0.0};
        double min_height = 0.0, max_height = 0.0;  // normal . (vertex - origin)
        std::uint32_t first_triangle = 0, triangle_count = 0;
        std::uint32_t first_edge = 0, edge_count = 0;
        bool is_whole = true;
    };

    struct PatchBuilder;

    const Patch* patch_of(Id occluder) const noexcept;
    bool hides(const geometry::MeshView& mesh,
               const Patch& patch,
               const ViewerRegion& viewer,
               const geometry::Aabb& box) const noexcept;

    std::uint32_t triangle_count_ = 0;
    std::vector<Patch> patches_;
    std::vector<geometry::TriangleId> triangles_;  // of the patches
    std::vector<Edge> edges_;                      // of their borders
    std::vector<std::uint32_t> patch_of_triangle_;
};

}  // namespace earshot::visibility
