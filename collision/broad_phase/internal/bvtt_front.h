// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::collision {

/// A node of the bounding-volume test tree (BVTT): two nodes of the BVH that are tested against
/// each other, or one against itself.
using BvttNode = std::pair<std::uint32_t, std::uint32_t>;

/// The front of the BVTT: the nodes at which the last traversal of the BVH against itself stopped,
/// culled pairs and pairs of leaves. While the BVH keeps its topology the next traversal begins
/// there instead of at the root (Klosowski 1998; Tang, Curtis, Yoon and Manocha 2009).
///
///     BVH         BVTT                 front
///     A           (A,A)
///     +- B        +- (B,B)
///     |  +- 1     |  +- (1,1)          *
///     |  +- 2     |  +- (2,2)          *
///     |           |  +- (1,2)          *
///     +- C        +- (C,C)
///        +- 3     |  +- (3,3)          *
///        +- 4     |  +- (4,4)          *
///                 |  +- (3,4)          *
///                 +- (B,C)
///                    +- (1,C)          *  culled: the boxes of 1 and C do not overlap
///                    +- (2,C)
///                       +- (2,3)       *
///                       +- (2,4)       *
///
/// The nodes with a star are the front: (1,C) is culled, the others are pairs of leaves. When the
/// meshes move a little, most of it stays valid. Where boxes of a culled node come to overlap, the
/// front sprouts downwards: (1,C) is replaced by (1,3) and (1,4). The front never moves up, so it
/// is rebuilt from the root every few steps.
///
/// The front is stored in sub-fronts, which are the tasks of a parallel traversal.
class BvttFront {
public:
    /// Discards the front, so that the next traversal begins at the root. To be called after the
    /// tree was replaced.
    void reset() { subfronts_.clear(); }

    /// To be called before each traversal: rebuilds the front from the root every kMaxAge steps, or
    /// at every step if `track` is false.
    template <class Traversal>
    void prepare(const bvh::Tree& tree, bool track, Traversal& traversal) {
        if (!track || subfronts_.empty() || ++age_ == kMaxAge) {
            restart_at_root(tree, [&](const BvttNode& node) { return traversal.is_culled(node); });
        }
    }

    std::size_t size() const noexcept { return subfronts_.size(); }
    std::vector<BvttNode>& subfront(std::size_t index) noexcept { return subfronts_[index]; }

private:
    static constexpr int kMaxAge = 8;

    /// Expands the BVTT from its root, except for culled nodes, until there are enough sub-fronts.
    void restart_at_root(const bvh::Tree& tree,
                         const std::function<bool(const BvttNode&)>& is_culled);

    std::vector<std::vector<BvttNode>> subfronts_;
    int age_ = 0;
};

/// Appends the children of a BVTT node. Precondition: not a pair of leaves.
void expand(const bvh::Tree& tree, BvttNode node, std::vector<BvttNode>& children);

/// Traverses one sub-front of a BVH against itself. `Tester` has
///   bool accepts(mesh, mesh)          whether contacts of two meshes are requested,
///   bool is_contact_free(node)        whether no two triangles below a node are in contact,
///   bool disjoint_leaves(node, node)  whether no triangles of two leaves are in contact,
///   void test(slot, slot)             called for every pair of slots whose boxes overlap, once
///                                     per pair and traversal of the whole front.
template <class Tester>
class SelfTraversal {
public:
    SelfTraversal(const SweptBvh& swept_bvh, Tester& tester)
        : swept_bvh_(swept_bvh), nodes_(swept_bvh.tree().nodes()), tester_(tester) {}

    /// Whether no requested contact can lie below a BVTT node.
    bool is_culled(const BvttNode& node) {
        const auto [a, b] = node;
        ++box_tests_;
        // Boxes first: most nodes are culled by them alone.
        if (a != b && !overlap(nodes_[a].box, nodes_[b].box)) {
            return true;
        }
        const std::uint32_t mesh_a = swept_bvh_.mesh_of_node(a);
        const std::uint32_t mesh_b = swept_bvh_.mesh_of_node(b);
        if (mesh_a != SweptBvh::kMixedMeshes && mesh_b != SweptBvh::kMixedMeshes &&
            !tester_.accepts(mesh_a, mesh_b)) {
            return true;
        }
        return a == b && tester_.is_contact_free(a);
    }

    /// Replaces the sub-front by the nodes at which its traversal stops.
    void run(std::vector<BvttNode>& subfront) {
        const std::vector<BvttNode> start = std::move(subfront);
        subfront.clear();
        subfront.reserve(start.size());
        std::vector<BvttNode> stack;
        for (const BvttNode& first : start) {
            stack.push_back(first);
            while (!stack.empty()) {
                const BvttNode node = stack.back();
                stack.pop_back();
                if (visit(node)) {
                    subfront.push_back(node);
                } else {
                    expand(swept_bvh_.tree(), node, stack);
                }
            }
        }
    }

    /// The number of tests of boxes and normal cones.
    std::uint64_t box_tests() const noexcept { return box_tests_; }

private:
    /// Whether the traversal stops at a node. The pairs of slots of a pair of leaves are tested.
    bool visit(const BvttNode& node) {
        if (is_culled(node)) {
            return true;
        }
        if (!nodes_[node.first].is_leaf() || !nodes_[node.second].is_leaf()) {
            return false;
        }
        if (node.first == node.second || !tester_.disjoint_leaves(node.first, node.second)) {
            test_leaves(node);
        }
        return true;
    }

    void test_leaves(const BvttNode& node) {
        const SlotRange left = swept_bvh_.slots_of_node(node.first);
        const SlotRange right = swept_bvh_.slots_of_node(node.second);
        for (std::uint32_t i = left.begin; i < left.end; ++i) {
            for (std::uint32_t k = node.first == node.second ? i + 1 : right.begin; k < right.end;
                 ++k) {
                ++box_tests_;
                if (overlap(swept_bvh_.box(i), swept_bvh_.box(k))) {
                    tester_.test(i, k);
                }
            }
        }
    }

    static bool overlap(const geometry::Aabb& a, const geometry::Aabb& b) noexcept {
        return (a.lower[0] <= b.upper[0]) & (b.lower[0] <= a.upper[0]) &
               (a.lower[1] <= b.upper[1]) & (b.lower[1] <= a.upper[1]) &
               (a.lower[2] <= b.upper[2]) & (b.lower[2] <= a.upper[2]);
    }

    const SweptBvh& swept_bvh_;
    std::span<const bvh::Node> nodes_;
    Tester& tester_;
    std::uint64_t box_tests_ = 0;
};

}  // namespace earshot::collision
