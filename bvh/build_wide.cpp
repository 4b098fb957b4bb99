// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/bvh/internal/bottom_up.h"
#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// What goes into a slot: a subtree, or a run of the primitives of a leaf that is too large for
/// one slot.
struct Slot {
    std::uint32_t node = kNone;
    std::uint32_t run_begin = 0, run_end = 0;  // equal: the whole subtree
};

// Of a visit, relative to each other.
constexpr float kNodeCost = 1.0F;
constexpr float kLeafCost = 1.0F;

using Slots = std::array<Slot, WideNode::kWidth>;

/// Decides which subtrees become the slots of which wide node, so that the expected number of steps
/// of a random ray is the least possible for this binary tree (Ylitie, Karras and Laine 2017,
/// section 3.2: dynamic programming from the leaves up).
class Collapse {
public:
    Collapse(const Tree& tree, LeafEncoding leaves, Executor& executor)
        : tree_(tree), leaves_(leaves), counts_(tree.nodes().size()), plans_(tree.nodes().size()) {
        for_each_bottom_up(tree.nodes(), executor, [&](std::size_t i) { plan(i); });
    }

    /// Appends the wide nodes of the subtree in depth-first order and returns the first's index.
    std::uint32_t place(std::uint32_t root) {
        const auto index = static_cast<std::uint32_t>(slots.size());
        slots.emplace_back();
        children.emplace_back();
        children.back().fill(kNoChild);
        std::size_t count = 0;
        open(root, index, count);
        for (std::size_t i = 0; i < count; ++i) {
            const Slot slot = slots[index][i];
            if (is_inner(slot)) {
                children[index][i] = place(slot.node);
            } else {
                const std::uint32_t in_leaf = count_of(slot);
                children[index][i] =
                    kLeafFlag | (in_leaf - 1) << kLeafCountShift | active_instances_;
                active_instances_ += static_cast<std::uint32_t>(leaf_blocks(leaves_, in_leaf));
            }
        }
        return index;
    }

    /// For all leaves together.
    std::size_t places() const { return active_instances_; }

    std::vector<Slots> slots;
    std::vector<std::array<std::uint32_t, WideNode::kWidth>> children;

private:
    static constexpr std::size_t kMostSlots = WideNode::kWidth - 1;

    /// What a subtree costs in at most j + 1 slots, and how the slots are shared out.
    struct Plan {
        std::array<float, kMostSlots> cost;
        std::array<std::uint8_t, kMostSlots> left;  // slots of the left child; 0: one slot for all
        std::uint8_t left_of_eight;                 // if the subtree is a wide node
        bool is_leaf;
    };

    void plan(std::size_t index) {
        const Node& node = tree_.nodes()[index];
        Plan& result = plans_[index];
        const float area = probability(node);
        if (node.is_leaf()) {
            counts_[index] = static_cast<std::uint8_t>(node.count);
            // A leaf too large for a slot becomes a node with two.
            const bool fits = node.count <= kMaxLeafTriangles;
            result.cost.fill(area * (fits ? kLeafCost : kNodeCost + 2.0F * kLeafCost));
            result.left.fill(0);
            result.is_leaf = fits;
            return;
        }
        const Plan& left = plans_[node.first];
        const Plan& right = plans_[node.first + 1];
        const std::uint32_t count = counts_[node.first] + counts_[node.first + 1U];
        counts_[index] = static_cast<std::uint8_t>(std::min(count, 255U));
        std::array<float, WideNode::kWidth + 1> shared{};  // the children's cost in i slots
        std::array<std::uint8_t, WideNode::kWidth + 1> best{};
        const std::size_t most = most_useful(left) + most_useful(right);
        for (std::size_t i = 2; i <= WideNode::kWidth; ++i) {
            if (i > most) {
                shared[i] = shared[i - 1];
                best[i] = best[i - 1];
                continue;
            }
            shared[i] = std::numeric_limits<float>::infinity();
            for (std::size_t k = 1; k < i; ++k) {
                const float cost = left.cost[k - 1] + right.cost[i - k - 1];
                if (cost < shared[i]) {
                    shared[i] = cost;
                    best[i] = static_cast<std::uint8_t>(k);
                }
            }
        }
        const float as_leaf =
            count <= kMaxLeafTriangles ? area * kLeafCost : std::numeric_limits<float>::infinity();
        const float as_node = area * kNodeCost + shared[WideNode::kWidth];
        result.is_leaf = count <= kMaxLeafTriangles && as_leaf <= as_node;
        result.left_of_eight = best[WideNode::kWidth];
        result.cost[0] = std::min(as_leaf, as_node);
        result.left[0] = 0;
        for (std::size_t i = 2; i <= kMostSlots; ++i) {
            const bool is_better = shared[i] < result.cost[i - 2];
            result.cost[i - 1] = is_better ? shared[i] : result.cost[i - 2];
            result.left[i - 1] = is_better ? best[i] : result.left[i - 2];
        }
    }

    /// More slots than these do not make a subtree cheaper.
    static std::size_t most_useful(const Plan& plan) {
        std::size_t most = kMostSlots;
        while (most > 1 && plan.cost[most - 2] == plan.cost[most - 1]) {
            --most;
        }
        return most;
    }

    /// Of being met by a ray that meets the root's box; 1 if that cannot be told.
    float probability(const Node& node) const {
        const double ratio = node.box.half_area() / tree_.nodes().front().box.half_area();
        return ratio <= 1.0 ? static_cast<float>(ratio) : 1.0F;
    }

    bool is_inner(const Slot& slot) const {
        return slot.run_begin == slot.run_end && !plans_[slot.node].is_leaf;
    }

    std::uint32_t count_of(const Slot& slot) const {
        return slot.run_begin != slot.run_end ? slot.run_end - slot.run_begin : counts_[slot.node];
    }

    /// Fills the slots of a wide node.
    void open(std::uint32_t root, std::size_t index, std::size_t& count) {
        const Node& node = tree_.nodes()[root];
        if (plans_[root].is_leaf) {
            slots[index][count++] = {root};
        } else if (node.is_leaf()) {
            const std::uint32_t end = node.first + node.count;
            const std::uint32_t middle = node.first + node.count / 2;
            slots[index][count++] = {root, node.first, middle};
            slots[index][count++] = {root, middle, end};
        } else {
            const std::uint8_t left = plans_[root].left_of_eight;
            share(node.first, left, index, count);
            share(node.first + 1, WideNode::kWidth - left, index, count);
        }
    }

    void share(std::uint32_t root, std::size_t slots_left, std::size_t index, std::size_t& count) {
        const std::uint8_t left = plans_[root].left[slots_left - 1];
        if (left == 0) {
            slots[index][count++] = {root};
            return;
        }
        const std::size_t used = std::min(slots_left, most_useful(plans_[root]));
        const std::uint32_t first = tree_.nodes()[root].first;
        share(first, left, index, count);
        share(first + 1, used - left, index, count);
    }

    const Tree& tree_;
    LeafEncoding leaves_;
    LargeArray<std::uint8_t> counts_;  // of the primitives below a node; 255: or more
    LargeArray<Plan> plans_;
    std::uint32_t active_instances_ = 0;
};

/// Writes the primitives of a subtree.
std::uint32_t* write_primitives(const Tree& tree, std::uint32_t index, std::uint32_t* out) {
    const Node& node = tree.nodes()[index];
    if (node.is_leaf()) {
        return std::copy_n(tree.primitives().begin() + node.first, node.count, out);
    }
    return write_primitives(tree, node.first + 1, write_primitives(tree, node.first, out));
}

}  // namespace

WideTree WideTree::build(const Tree& tree,
                         const geometry::MeshView& mesh,
                         Executor& executor,
                         LeafEncoding leaves) {
    const std::size_t count = tree.primitives().size();
    const std::size_t most = (std::size_t{1} << kLeafCountShift) / leaf_blocks(leaves, 1);
    if (count >= most) {
        throw Error("hierarchy",
                    "cannot hold " + std::to_string(most) + " triangles or more",
                    leaves == LeafEncoding::single ? "split the scene"
                                                   : "split the scene, or do not quantise");
    }
    WideTree wide;
    wide.leaf_encoding_ = leaves;
    wide.words_per_block_ = words_per_block(leaves);
    if (count == 0) {
        return wide;
    }
    Collapse collapse(tree, leaves, executor);
    collapse.place(0);
    wide.triangle_count_ = count;
    wide.box_ = tree.nodes().front().box;
    wide.nodes_.resize(collapse.slots.size());
    wide.words_.resize(wide.words_per_block_ * collapse.places() + kPaddingWords);
    std::fill_n(wide.words_.end() - kPaddingWords, kPaddingWords, 0U);
    const auto set_node = [&](std::size_t i) {
        WideNode& node = wide.nodes_[i];
        for (std::size_t k = 0; k < WideNode::kWidth; ++k) {
            const Slot& slot = collapse.slots[i][k];
            node.child[k] = collapse.children[i][k];
            set_slot_box(node, k, slot.node == kNone ? Aabb::empty() : tree.nodes()[slot.node].box);
            if (slot.node == kNone || !is_leaf(node.child[k])) {
                continue;
            }
            const std::size_t in_leaf = leaf_count(node.child[k]);
            std::uint32_t* out =
                wide.packed_leaf(node.child[k]) + triangle_ids_offset(leaves, in_leaf);
            if (slot.run_begin != slot.run_end) {
                std::copy_n(tree.primitives().begin() + slot.run_begin, in_leaf, out);
            } else {
                write_primitives(tree, slot.node, out);
            }
            fetch_triangles({out, in_leaf}, mesh);
        }
        set_order(node);
    };
    const auto for_each_leaf = [&](std::size_t i, auto&& visit) {
        for (const std::uint32_t child : wide.nodes_[i].child) {
            if (is_leaf(child)) {
                visit(child);
            }
        }
    };
    // Chunks are short, so that what was fetched for a chunk is still there when it is wanted.
    constexpr std::size_t kGrain = 16;
    executor.for_each(wide.nodes_.size(), 64 * kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t begin = first; begin < last; begin += kGrain) {
            const std::size_t end = std::min(begin + kGrain, last);
            for (std::size_t i = begin; i < end; ++i) {
                set_node(i);
            }
            for (std::size_t i = begin; i < end; ++i) {
                for_each_leaf(
                    i, [&](std::uint32_t leaf) { fetch_corners(wide.leaf_triangles(leaf), mesh); });
            }
            for (std::size_t i = begin; i < end; ++i) {
                for_each_leaf(i, [&](std::uint32_t leaf) {
                    fill_leaf(leaves, wide.packed_leaf(leaf), leaf_count(leaf), mesh);
                });
            }
        }
    });
    return wide;
}

double WideTree::max_abs_coordinate() const noexcept {
    double largest = 0.0;
    for (std::size_t k = 0; k < 3 && triangle_count_ > 0; ++k) {
        largest = std::max({largest,
                            std::abs(static_cast<double>(box_.lower[k])),
                            std::abs(static_cast<double>(box_.upper[k]))});
    }
    return largest;
}

std::span<const std::uint32_t> WideTree::leaf_triangles(std::uint32_t child) const noexcept {
    const std::size_t count = leaf_count(child);
    return {packed_leaf(child) + triangle_ids_offset(leaf_encoding_, count), count};
}

std::size_t WideTree::bytes() const noexcept {
    return nodes_.size() * sizeof(WideNode) + words_.size() * sizeof(std::uint32_t);
}

}  // namespace earshot::bvh
