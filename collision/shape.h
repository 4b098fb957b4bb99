// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/large_array.h"
#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/geometry/mesh.h"

#include <glm/mat3x3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::collision {

/// Up to eight child boxes in SIMD lanes, as centre and half sides for separating-axis tests. The
/// triangles of a box also lie in a slab whose normal is their mean normal: around a piece of
/// surface it is thin.
struct alignas(64) BoxNode {
    static constexpr std::size_t kWidth = 8;

    float centre[3][kWidth];
    float half[3][kWidth];
    float normal[3][kWidth];    ///< of the slab; any length up to 1, within a rounding
    float slab_centre[kWidth];  ///< along the normal, from the box's centre
    float slab_half[kWidth];
    std::uint32_t child[kWidth];  ///< a node's index, or kTriangleFlag + a leaf's
    std::uint32_t count;          ///< of the children, which fill the first slots
};

static_assert(sizeof(BoxNode) == 448);

inline constexpr std::uint32_t kTriangleFlag = 0x80000000U;

/// A mesh prepared for collision queries: an eight-wide BVH whose leaves are single triangles. It
/// keeps a view of the mesh, and the binary tree that it was collapsed from, by which it follows a
/// mesh that deforms.
class Shape {
public:
    Shape() = default;

    /// The hierarchy is that of bvh::Tree::build() over the triangles' boxes, one triangle to a
    /// leaf (options.max_leaf_size is not looked at), collapsed. Answers do not depend on it.
    /// Throws Error as bvh::Tree::build(), and if a coordinate is beyond kMaxCoordinate.
    /// Preconditions: those of MeshView; the mesh's arrays stay where they are as long as the shape
    /// is used.
    static Shape build(const geometry::MeshView& mesh,
                       const bvh::BuildOptions& options = {},
                       Executor& executor = Executor::serial());

    /// Moves the hierarchy to where the mesh's vertices are now: refitted, repaired or rebuilt, as
    /// bvh::DeformableBvh decides. Throws and requires what build() does. Precondition: the mesh
    /// has the triangles of build().
    bvh::UpdateReport update(const geometry::MeshView& mesh,
                             Executor& executor = Executor::serial());

    /// Tells how many nodes queries have visited since the last update, which is taken for what
    /// they will visit until the next one; 0: updates only refit. Without it an update assumes a
    /// query of the mesh against itself.
    void expect_node_visits(double visits) noexcept { bvh_.expect_node_visits(visits); }

    const geometry::MeshView& mesh() const noexcept { return mesh_; }

    /// The root first, parents before children; none if there are no triangles. The root's own box
    /// stands in slot 0 of the first node, which has that one child.
    std::span<const BoxNode> nodes() const noexcept { return nodes_; }

    /// Of each leaf the triangle, and where its corners are.
    std::span<const geometry::TriangleId> triangles() const noexcept {
        return bvh_.binary_tree().primitives();
    }
    std::span<const Corners> corners() const noexcept { return corners_; }

    /// The largest absolute coordinate of a triangle, rounded up; 0 without triangles.
    double max_abs_coordinate() const noexcept { return max_abs_coordinate_; }

    /// Metres. Squares of smaller coordinates are finite in single precision.
    static constexpr double kMaxCoordinate = 0x1p60;

private:
    /// What the slots of a node stand for: nodes of the binary tree, and ranges of leaves.
    struct SlotSources {
        std::array<std::uint32_t, BoxNode::kWidth> node, first_leaf, leaf_count;
    };
    friend class ShapeCollapse;

    void follow(const geometry::MeshView& mesh, Executor& executor);

    geometry::MeshView mesh_;
    bvh::DeformableBvh bvh_;     // over the triangles' boxes, one to a leaf
    std::uint64_t version_ = 0;  // of the binary tree that the nodes were collapsed from
    LargeArray<BoxNode> nodes_;
    LargeArray<SlotSources> sources_;
    LargeArray<Corners> corners_;
    double max_abs_coordinate_ = 0.0;
};

/// A rigid pose: a point p of a mesh is at rotation * p + translation.
struct Pose {
    glm::dmat3 rotation{1.0};
    geometry::Vec3 translation{0.0};

    /// The transformed point, rounded to doubles; p itself with the default pose. Queries about
    /// meshes in a pose are, exactly, queries about vertices at these points.
    geometry::Vec3 apply(const geometry::Vec3& p) const noexcept {
        geometry::Vec3 placed;
        for (int k = 0; k < 3; ++k) {
            placed[k] =
                rotation[0][k] * p.x + rotation[1][k] * p.y + rotation[2][k] * p.z + translation[k];
        }
        return placed;
    }
};

/// A shape in the world.
struct Body {
    const Shape& shape;
    Pose pose{};
};

}  // namespace earshot::collision
