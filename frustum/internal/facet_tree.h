// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/bvh/tree.h"
#include "earshot/frustum/internal/box_cull.h"
#include "earshot/geometry/aabb.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

struct Frustum;

/// The boxes of up to eight children side by side: of facets, or around all that lies below a node.
struct alignas(64) FacetNode {
    static constexpr std::size_t kWidth = 8;
    static constexpr std::uint32_t kFacetFlag = 0x80000000U;

    double lower[3][kWidth] = {};
    double upper[3][kWidth] = {};
    std::uint32_t child[kWidth] = {};  ///< a facet with kFacetFlag, or the index of a node
    std::uint32_t used = 0;            ///< bit i: slot i has a child
};

/// A hierarchy over the boxes of facets, of eight children per node.
class FacetTree {
public:
    FacetTree() = default;

    /// Joins levels of a binary hierarchy. `boxes`: one per facet, in which it was built or
    /// refitted last; it has fewer than 2^31.
    FacetTree(const bvh::Tree& tree, std::span<const geometry::Aabb> boxes);

    /// Parents before children, the root first; none if there are no facets.
    std::span<const FacetNode> nodes() const noexcept { return nodes_; }

private:
    std::vector<FacetNode> nodes_;
};

/// A frustum, as the boxes of a node's children are compared with it.
struct FrustumBoxTest {
    /// `half_spaces`: of the frustum's BoxCull; the first five count. `position_error`: of points
    /// along the frustum's axes, metres.
    FrustumBoxTest(const Frustum& frustum,
                   const HalfSpaces& half_spaces,
                   double position_error) noexcept;

    static constexpr std::size_t kHalfSpaces = 5;

    double normal[kHalfSpaces][3];
    double offset[kHalfSpaces];
    std::size_t farthest[kHalfSpaces][3];  ///< where the sides along a normal lie in a FacetNode
    double apex[3];
    double axes[3][3], abs_axes[3][3];        ///< right, up, forward
    double grid_lower[2], cells_per_unit[2];  ///< of u and v
    double grid_side;                         ///< in cells
    double slack, slack_by_depth;             ///< in cells; the second at a depth of 1 m
};

/// What the boxes of a node's children span along a frustum's axes, relative to its apex.
struct alignas(64) ChildBounds {
    static constexpr std::size_t kWidth = FacetNode::kWidth;
    double centre_depth[kWidth], min_depth[kWidth];  ///< along `forward`, metres
    // Of boxes whose least depth is positive, bounds of u and v of all points:
    double lower[2][kWidth], upper[2][kWidth];
    std::uint64_t cells[kWidth];  ///< that these bounds, grown by the slack, overlap
};

/// Bits of the children whose boxes lie in no half-space wholly outside. The boxes of these are
/// projected; the others' values have no meaning. The same bits on every instruction set.
std::uint32_t project_boxes(const FrustumBoxTest& test,
                            const FacetNode& node,
                            ChildBounds& projected) noexcept;

}  // namespace earshot::frustum
