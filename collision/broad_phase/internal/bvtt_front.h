// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::collision {

/// Two nodes of a tree.
using NodePair = std::pair<std::uint32_t, std::uint32_t>;

/// Where a search of a tree against itself ended, part by part: pairs of leaves, and pairs that
/// need not be divided. While the tree keeps its topology the next search begins here (Klosowski
/// 1998; Tang, Curtis, Yoon and Manocha 2009).
class PairFront {
public:
    /// The next search begins at the root: for a new tree.
    void reset() { parts_.clear(); }

    /// To be called before each search. A front only moves down, so it is dropped now and then, or
    /// at once if it is not to be kept.
    template <class Search>
    void prepare(const bvh::Tree& tree, bool is_kept, Search& search) {
        if (!is_kept || parts_.empty() || ++age_ == kLargestAge) {
            begin_at_root(tree, [&](const NodePair& pair) { return search.is_settled(pair); });
        }
    }

    std::size_t parts() const noexcept { return parts_.size(); }
    std::vector<NodePair>& part(std::size_t index) noexcept { return parts_[index]; }

private:
    static constexpr int kLargestAge = 8;

    /// Divides the pair of roots, but for pairs that are settled, until there are parts enough.
    void begin_at_root(const bvh::Tree& tree,
                       const std::function<bool(const NodePair&)>& is_settled);

    std::vector<std::vector<NodePair>> parts_;
    int age_ = 0;
};

/// Appends the pairs that a pair is divided into. Precondition: not two leaves.
void divide(const bvh::Tree& tree, NodePair pair, std::vector<NodePair>& into);

/// Searches one part of a tree against itself. `Rules` has
///   bool accepts(mesh, mesh)         whether anything of two meshes is looked at,
///   bool is_free_of_contact(node)      whether all triangles below a node are known not to touch
///                                      each other,
///   bool are_leaves_apart(node, node)  whether nothing of two leaves is known to touch,
///   void test(slot, slot)              which gets every pair of slots whose boxes meet, each pair
///                                      of the whole search once.
template <class Rules>
class PartSearch {
public:
    PartSearch(const SweptForest& forest, Rules& rules)
        : forest_(forest), nodes_(forest.tree().nodes()), rules_(rules) {}

    /// Whether nothing of a pair of nodes can touch, or is looked at.
    bool is_settled(const NodePair& pair) {
        const auto [a, b] = pair;
        ++tests_;
        // Boxes first: nothing but the nodes is looked at for most pairs.
        if (a != b && !intersect(nodes_[a].box, nodes_[b].box)) {
            return true;
        }
        const std::uint32_t mesh_a = forest_.mesh_of_node(a);
        const std::uint32_t mesh_b = forest_.mesh_of_node(b);
        if (mesh_a != SweptForest::kManyMeshes && mesh_b != SweptForest::kManyMeshes &&
            !rules_.accepts(mesh_a, mesh_b)) {
            return true;
        }
        return a == b && rules_.is_free_of_contact(a);
    }

    /// Moves the part to where the search ended.
    void run(std::vector<NodePair>& part) {
        const std::vector<NodePair> start = std::move(part);
        part.clear();
        part.reserve(start.size());
        std::vector<NodePair> open;
        for (const NodePair& first : start) {
            open.push_back(first);
            while (!open.empty()) {
                const NodePair pair = open.back();
                open.pop_back();
                if (ends_at(pair)) {
                    part.push_back(pair);
                } else {
                    divide(forest_.tree(), pair, open);
                }
            }
        }
    }

    /// How many boxes and patches were tested.
    std::uint64_t tests() const noexcept { return tests_; }

private:
    bool ends_at(const NodePair& pair) {
        if (is_settled(pair)) {
            return true;
        }
        if (!nodes_[pair.first].is_leaf() || !nodes_[pair.second].is_leaf()) {
            return false;
        }
        if (pair.first == pair.second || !rules_.are_leaves_apart(pair.first, pair.second)) {
            test_leaves(pair);
        }
        return true;
    }

    void test_leaves(const NodePair& pair) {
        const SlotRange left = forest_.slots_of_node(pair.first);
        const SlotRange right = forest_.slots_of_node(pair.second);
        for (std::uint32_t i = left.begin; i < left.end; ++i) {
            for (std::uint32_t k = pair.first == pair.second ? i + 1 : right.begin; k < right.end;
                 ++k) {
                ++tests_;
                if (intersect(forest_.box(i), forest_.box(k))) {
                    rules_.test(i, k);
                }
            }
        }
    }

    static bool intersect(const geometry::Aabb& a, const geometry::Aabb& b) noexcept {
        return (a.lower[0] <= b.upper[0]) & (b.lower[0] <= a.upper[0]) &
               (a.lower[1] <= b.upper[1]) & (b.lower[1] <= a.upper[1]) &
               (a.lower[2] <= b.upper[2]) & (b.lower[2] <= a.upper[2]);
    }

    const SweptForest& forest_;
    std::span<const bvh::Node> nodes_;
    Rules& rules_;
    std::uint64_t tests_ = 0;
};

}  // namespace earshot::collision
