// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace earshot::collision {

/// A node of the bounding-volume test tree (BVTT): two nodes of the BVH that are tested against
/// each other, the one of the lower index first, or one against itself.
struct BvttNode {
    std::uint32_t first = 0, second = 0;

    bool is_self() const noexcept { return first == second; }
    friend bool operator==(const BvttNode&, const BvttNode&) = default;
};

/// A node of the front: one at which the last traversal stopped.
struct FrontEntry {
    std::uint32_t first = 0, second = 0;  // of the BVTT node; the upper bit of each is a flag

    static constexpr std::uint32_t kFlag = 0x80000000U;

    FrontEntry() = default;
    FrontEntry(const BvttNode& node, bool is_culled, bool is_newly_culled) noexcept
        : first(node.first | (is_culled ? kFlag : 0)),
          second(node.second | (is_newly_culled ? kFlag : 0)) {}

    BvttNode node() const noexcept { return {first & ~kFlag, second & ~kFlag}; }
    /// Culled, or else a pair of leaves.
    bool is_culled() const noexcept { return (first & kFlag) != 0; }
    /// Culled by the last traversal, and a pair of leaves or expanded before it.
    bool is_newly_culled() const noexcept { return (second & kFlag) != 0; }
};

/// The children of a BVTT node.
struct BvttChildren {
    std::array<BvttNode, 3> nodes;
    std::size_t count = 0;
};

/// Precondition: not a pair of leaves.
BvttChildren expand(std::span<const bvh::Node> nodes, const BvttNode& node) noexcept;

/// The node of the BVTT whose children are the last two, or three, of these entries; nothing if
/// they are not all culled, or not the children of one node.
struct BvttParent {
    BvttNode node;
    std::size_t children = 0;  ///< 0: there is none
    bool any_newly_culled = false;
};
BvttParent parent_of_last(std::span<const FrontEntry> entries,
                          std::span<const std::uint32_t> parents) noexcept;

/// Traverses a BVH against itself, from a front. `Tester` has
///   bool culls(node, node)         whether no wanted pair of primitives lies below two nodes whose
///                                  boxes overlap, or below one node and itself,
///   uint64_t test_leaves(node, node)  called for every pair of leaves that is not culled, once per
///                                  traversal of the whole front; returns how many boxes it tested.
template <class Tester>
class SelfTraversal {
public:
    /// `parents` of the nodes.
    SelfTraversal(std::span<const bvh::Node> nodes,
                  std::span<const std::uint32_t> parents,
                  Tester& tester)
        : nodes_(nodes), parents_(parents), tester_(tester) {}

    /// Whether no wanted pair can lie below a BVTT node.
    bool is_culled(const BvttNode& node) {
        ++box_tests_;
        // Boxes first: most nodes are culled by them alone.
        return (!node.is_self() && !overlap(nodes_[node.first].box, nodes_[node.second].box)) ||
               tester_.culls(node.first, node.second);
    }

    /// Follows a sub-front, which moves down where boxes have come to overlap and up where they
    /// have parted. It moves up to nodes of which a child has just been culled, and with
    /// `retry_parents` to all whose children are.
    void run(std::vector<FrontEntry>& subfront, bool retry_parents) {
        const std::vector<FrontEntry> before = std::move(subfront);
        subfront.clear();
        subfront.reserve(before.size());
        std::vector<BvttNode> stack;
        std::size_t newly_culled_end = 0;  // one beyond the last entry that was newly culled
        for (const FrontEntry& entry : before) {
            const BvttNode node = entry.node();
            if (is_culled(node)) {
                subfront.emplace_back(node, true, !entry.is_culled());
                newly_culled_end = entry.is_culled() ? newly_culled_end : subfront.size();
                if ((retry_parents || newly_culled_end + kMaxChildren > subfront.size()) &&
                    move_up(subfront, retry_parents)) {
                    newly_culled_end = subfront.size();
                }
            } else {
                stack.push_back(node);
                descend(stack, subfront);
            }
        }
    }

    /// The number of tests of boxes and of what the tester does to cull.
    std::uint64_t box_tests() const noexcept { return box_tests_; }

    static bool overlap(const geometry::Aabb& a, const geometry::Aabb& b) noexcept {
        return (a.lower[0] <= b.upper[0]) & (b.lower[0] <= a.upper[0]) &
               (a.lower[1] <= b.upper[1]) & (b.lower[1] <= a.upper[1]) &
               (a.lower[2] <= b.upper[2]) & (b.lower[2] <= a.upper[2]);
    }

private:
    static constexpr std::size_t kMaxChildren = std::tuple_size_v<decltype(BvttChildren::nodes)>;

    /// Visits what is below a node that is not culled, the only one on the stack.
    void descend(std::vector<BvttNode>& stack, std::vector<FrontEntry>& subfront) {
        while (!stack.empty()) {
            const BvttNode node = stack.back();
            stack.pop_back();
            if (nodes_[node.first].is_leaf() && nodes_[node.second].is_leaf()) {
                box_tests_ += tester_.test_leaves(node.first, node.second);
                subfront.emplace_back(node, false, false);
                continue;
            }
            const BvttChildren children = expand(nodes_, node);
            // Culled children come before the others and what is below these: their parent has
            // just been tested, so the front does not move up to it.
            for (std::size_t i = 0; i < children.count; ++i) {
                if (is_culled(children.nodes[i])) {
                    subfront.emplace_back(children.nodes[i], true, false);
                } else {
                    stack.push_back(children.nodes[i]);
                }
            }
        }
    }

    /// Lauterbach 2010, section 6.2.3: where all children of a node are culled and so is the node,
    /// it takes their place, and then its parent may be next. Returns whether the front moved.
    bool move_up(std::vector<FrontEntry>& subfront, bool retry_parents) {
        for (bool has_moved = false;; has_moved = true) {
            const BvttParent parent = parent_of_last(subfront, parents_);
            if (parent.children == 0 || !(parent.any_newly_culled || retry_parents) ||
                !is_culled(parent.node)) {
                return has_moved;
            }
            subfront.resize(subfront.size() - parent.children);
            subfront.emplace_back(parent.node, true, true);
        }
    }

    std::span<const bvh::Node> nodes_;
    std::span<const std::uint32_t> parents_;
    Tester& tester_;
    std::uint64_t box_tests_ = 0;
};

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
/// primitives move a little, most of it stays valid. Where boxes of a culled node come to overlap,
/// the front moves down: (1,C) is replaced by (1,3) and (1,4). Where the boxes of all children of a
/// node part, it moves up (Lauterbach 2010, section 6.2.3): if (2,3) and (2,4) are culled and so is
/// (2,C), it replaces them. A parent is tested when one of its children has parted, and every few
/// steps.
///
/// The front is stored in sub-fronts, which are the tasks of a parallel traversal.
class BvttFront {
public:
    /// Discards the front, so that the next traversal begins at the root. To be called after the
    /// tree was replaced.
    void reset() { subfronts_.clear(); }

    /// Nodes of the BVTT at which the last traversal stopped.
    std::size_t size() const noexcept;

    /// Traverses a tree against itself. `new_tester()` makes the tester of a sub-front and
    /// finish(tester) takes it when its sub-front was followed, in the order of sub-fronts. They
    /// are followed in rounds of `round`, whose testers are made before any of them is followed.
    /// Without `track` the traversal begins at the root. Returns the number of box tests, which
    /// like everything else does not depend on the executor.
    template <typename NewTester, typename Finish>
    std::uint64_t traverse(const bvh::Tree& tree,
                           bool track,
                           std::size_t round,
                           Executor& executor,
                           NewTester&& new_tester,
                           Finish&& finish) {
        using Tester = decltype(new_tester());
        const std::span<const bvh::Node> nodes = tree.nodes();
        std::uint64_t box_tests = 0;
        if (!track || subfronts_.empty()) {
            find_parents(nodes);
            Tester tester = new_tester();
            SelfTraversal<Tester> top(nodes, parents_, tester);
            restart_at_root(nodes, [&](const BvttNode& node) { return top.is_culled(node); });
            box_tests += top.box_tests();
        } else {
            split_large_subfronts();
        }
        age_ = (age_ + 1) % kRetryAge;
        for (std::size_t first = 0; first < subfronts_.size(); first += round) {
            const std::size_t count = std::min(round, subfronts_.size() - first);
            std::vector<std::optional<Tester>> testers(count);
            std::vector<std::uint64_t> tests(count);
            for (std::optional<Tester>& tester : testers) {
                tester.emplace(new_tester());
            }
            executor.for_each(count, 1, [&](std::size_t i, std::size_t) {
                SelfTraversal<Tester> traversal(nodes, parents_, *testers[i]);
                traversal.run(subfronts_[first + i], age_ == 0);
                tests[i] = traversal.box_tests();
            });
            for (std::size_t i = 0; i < count; ++i) {
                finish(*testers[i]);
                box_tests += tests[i];
            }
        }
        return box_tests;
    }

private:
    static constexpr int kRetryAge = 8;

    void find_parents(std::span<const bvh::Node> nodes);

    /// Expands the BVTT from its root, except for culled nodes, until there are enough sub-fronts.
    template <typename IsCulled>
    void restart_at_root(std::span<const bvh::Node> nodes, IsCulled&& is_culled) {
        // There are far more sub-fronts than threads, so that the load is balanced.
        constexpr std::size_t kMinSubfronts = 1024;
        subfronts_.clear();
        if (nodes.empty()) {
            return;
        }
        std::vector<FrontEntry> culled;
        std::vector<BvttNode> level{BvttNode{}};
        for (bool has_inner = true; has_inner && level.size() < kMinSubfronts;) {
            has_inner = false;
            std::vector<BvttNode> next;
            for (const BvttNode& node : level) {
                if (nodes[node.first].is_leaf() && nodes[node.second].is_leaf()) {
                    next.push_back(node);
                } else if (is_culled(node)) {
                    culled.emplace_back(node, true, false);
                } else {
                    const BvttChildren children = expand(nodes, node);
                    next.insert(
                        next.end(),
                        children.nodes.begin(),
                        children.nodes.begin() + static_cast<std::ptrdiff_t>(children.count));
                    has_inner = true;
                }
            }
            level = std::move(next);
        }
        for (const BvttNode& node : level) {
            subfronts_.push_back({FrontEntry(node, true, false)});
        }
        subfronts_.push_back(std::move(culled));
    }

    /// Sub-fronts that have grown far beyond the others are split, to balance the load.
    void split_large_subfronts();

    std::vector<std::uint32_t> parents_;              // of the nodes of the tree
    std::vector<std::vector<FrontEntry>> subfronts_;  // siblings are neighbours
    int age_ = 0;                                     // steps since all parents were tested
};

}  // namespace earshot::collision
