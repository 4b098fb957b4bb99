// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/bvh/internal/bottom_up.h"
#include "earshot/bvh/internal/coordinate_rules.h"
#include "earshot/bvh/internal/wide_node.h"
#include "earshot/bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// The content of a slot: a subtree of the binary tree, or a run of the primitives of a binary leaf
/// that is too large for one slot.
struct Slot {
    std::uint32_t node = kNone;
    std::uint32_t run_begin = 0, run_end = 0;  // equal: the whole subtree
};

// Costs of a visit, relative to each other.
constexpr float kNodeCost = 1.0F;
constexpr float kLeafCost = 1.0F;

using Slots = std::array<Slot, WideNode::kWidth>;

/// The collapse of a binary tree to a wide one of the least SAH cost (Ylitie, Karras and Laine
/// 2017, section 3.2). Dynamic programming from the leaves up: for every subtree, the least cost of
/// a forest of at most i slots that holds it,
///
///     C(n, 1) = min(C_leaf(n), C_node(n))              one slot: a packed leaf, or a wide node
///     C(n, i) = min(C(n, i - 1), C_distribute(n, i))   its children share i slots, or one less is
///                                                      as good
///     C_distribute(n, i) = min over k of C(left, k) + C(right, i - k)
///     C_node(n) = A(n) * kNodeCost + C_distribute(n, 8)
///
///            n                     n's wide node, if the left child gets 3 of the slots:
///          /   \                   +---+---+---+---+---+---+---+---+
///       left   right         =>    | a | c | d | r |   |   |   |   |
///       /  \                       +---+---+---+---+---+---+---+---+
///      a    b    (r: right)
///          / \                     nodes between n and the slots (left, b) vanish
///         c   d
class Collapse {
public:
    Collapse(const Tree& tree, LeafEncoding encoding, Executor& executor)
        : tree_(tree), encoding_(encoding), costs_(tree.nodes().size() / 2) {
        const double root_area = tree.nodes().front().box.half_area();
        inverse_root_area_ = 1.0 / root_area;
        for_each_bottom_up(tree.nodes(), executor, [&](std::size_t i) {
            const Node& node = tree_.nodes()[i];
            if (!node.is_leaf()) {
                compute_costs(node);
            }
        });
        // Wide nodes have six children or so, of four triangles or so.
        slots.reserve(tree.nodes().size() / 8 + 1);
        children.reserve(slots.capacity());
    }

    /// Appends the wide nodes of the subtree in depth-first order and returns the first's index.
    std::uint32_t emit(std::uint32_t root) {
        const auto index = static_cast<std::uint32_t>(slots.size());
        slots.emplace_back();
        children.emplace_back();
        children.back().fill(kNoChild);
        std::size_t count = 0;
        fill_slots(root, index, count);
        for (std::size_t i = 0; i < count; ++i) {
            const Slot slot = slots[index][i];
            if (is_inner(slot)) {
                children[index][i] = emit(slot.node);
            } else {
                const std::uint32_t in_leaf = count_of(slot);
                children[index][i] = kLeafFlag | (in_leaf - 1) << kLeafCountShift | blocks_;
                blocks_ += static_cast<std::uint32_t>(leaf_blocks(encoding_, in_leaf));
            }
        }
        return index;
    }

    /// Blocks of all packed leaves.
    std::size_t blocks() const { return blocks_; }

    std::vector<Slots> slots;
    std::vector<std::array<std::uint32_t, WideNode::kWidth>> children;

private:
    static constexpr std::size_t kMaxSlots = WideNode::kWidth - 1;

    /// The least cost of a subtree in at most i slots, at [i - 1], and how many of these slots its
    /// left child gets.
    struct Costs {
        std::array<float, kMaxSlots> cost;
        std::array<std::uint8_t, kMaxSlots> left_slots;  // 0: one slot for the whole subtree
        std::uint8_t left_slots_of_node;                 // if the subtree becomes a wide node
        std::uint8_t useful_slots;                       // more of them do not make it cheaper
        std::uint8_t count;                              // of its primitives; 255: or more
        bool is_leaf;
    };

    /// Inner nodes have costs in memory, in the order of their children.
    Costs& costs_at(const Node& inner) { return costs_[inner.first / 2]; }
    const Costs& costs_at(const Node& inner) const { return costs_[inner.first / 2]; }

    Costs costs_of_leaf(const Node& leaf) const {
        Costs result{};
        // A leaf too large for a slot becomes a node with two.
        result.is_leaf = leaf.count <= kMaxLeafTriangles;
        result.cost.fill(probability(leaf) *
                         (result.is_leaf ? kLeafCost : kNodeCost + 2.0F * kLeafCost));
        result.useful_slots = 1;
        result.count = static_cast<std::uint8_t>(leaf.count);
        return result;
    }

    bool is_leaf_at(std::uint32_t index) const {
        const Node& node = tree_.nodes()[index];
        return node.is_leaf() ? node.count <= kMaxLeafTriangles : costs_at(node).is_leaf;
    }

    std::uint32_t count_at(std::uint32_t index) const {
        const Node& node = tree_.nodes()[index];
        return node.is_leaf() ? node.count : costs_at(node).count;
    }

    void compute_costs(const Node& node) {
        const Node* const pair = &tree_.nodes()[node.first];
        Costs of_leaf[2];
        const Costs* sides[2];
        for (std::size_t side = 0; side < 2; ++side) {
            if (pair[side].is_leaf()) {
                of_leaf[side] = costs_of_leaf(pair[side]);
                sides[side] = &of_leaf[side];
            } else {
                sides[side] = &costs_at(pair[side]);
            }
        }
        const Costs& left = *sides[0];
        const Costs& right = *sides[1];
        Costs& result = costs_at(node);
        const std::uint32_t count = std::uint32_t{left.count} + right.count;
        result.count = static_cast<std::uint8_t>(std::min(count, 255U));
        // C_distribute. Beyond the slots that are useful to a child its costs stay the same.
        const std::size_t max_slots =
            std::min<std::size_t>(left.useful_slots + right.useful_slots, WideNode::kWidth);
        std::array<float, WideNode::kWidth + 1> distributed;
        std::array<std::uint8_t, WideNode::kWidth + 1> left_slots;
        for (std::size_t i = 2; i <= max_slots; ++i) {
            const std::size_t first = i > right.useful_slots ? i - right.useful_slots : 1;
            const std::size_t last = std::min<std::size_t>(left.useful_slots, i - 1);
            float best = std::numeric_limits<float>::infinity();
            std::size_t best_left = first;
            for (std::size_t k = first; k <= last; ++k) {
                const float cost = left.cost[k - 1] + right.cost[i - k - 1];
                best_left = cost < best ? k : best_left;
                best = cost < best ? cost : best;
            }
            distributed[i] = best;
            left_slots[i] = static_cast<std::uint8_t>(best_left);
        }
        // One slot: a leaf or a node.
        const float area = probability(node);
        const float as_node = area * kNodeCost + distributed[max_slots];
        result.is_leaf = count <= kMaxLeafTriangles && area * kLeafCost <= as_node;
        result.left_slots_of_node = left_slots[max_slots];
        result.cost[0] = result.is_leaf ? area * kLeafCost : as_node;
        result.left_slots[0] = 0;
        result.useful_slots = 1;
        for (std::size_t i = 2; i <= kMaxSlots; ++i) {
            const bool is_better = i <= max_slots && distributed[i] < result.cost[i - 2];
            result.cost[i - 1] = is_better ? distributed[i] : result.cost[i - 2];
            result.left_slots[i - 1] = is_better ? left_slots[i] : result.left_slots[i - 2];
            result.useful_slots = is_better ? static_cast<std::uint8_t>(i) : result.useful_slots;
        }
    }

    /// The probability that a ray which hits the root's box hits the node's; 1 if it is unknown.
    float probability(const Node& node) const {
        const double ratio = node.box.half_area() * inverse_root_area_;
        return ratio <= 1.0 ? static_cast<float>(ratio) : 1.0F;
    }

    bool is_inner(const Slot& slot) const {
        return slot.run_begin == slot.run_end && !is_leaf_at(slot.node);
    }

    std::uint32_t count_of(const Slot& slot) const {
        return slot.run_begin != slot.run_end ? slot.run_end - slot.run_begin : count_at(slot.node);
    }

    /// Fills the slots of a wide node.
    void fill_slots(std::uint32_t root, std::size_t index, std::size_t& count) {
        const Node& node = tree_.nodes()[root];
        if (is_leaf_at(root)) {
            slots[index][count++] = {root};
        } else if (node.is_leaf()) {
            const std::uint32_t end = node.first + node.count;
            const std::uint32_t middle = node.first + node.count / 2;
            slots[index][count++] = {root, node.first, middle};
            slots[index][count++] = {root, middle, end};
        } else {
            const std::uint8_t left = costs_at(node).left_slots_of_node;
            distribute(node.first, left, index, count);
            distribute(node.first + 1, WideNode::kWidth - left, index, count);
        }
    }

    /// Fills at most `available` slots with the forest of a subtree.
    void distribute(std::uint32_t root,
                    std::size_t available,
                    std::size_t index,
                    std::size_t& count) {
        const Node& node = tree_.nodes()[root];
        const std::uint8_t left = node.is_leaf() ? 0 : costs_at(node).left_slots[available - 1];
        if (left == 0) {
            slots[index][count++] = {root};
            return;
        }
        const std::size_t used = std::min<std::size_t>(available, costs_at(node).useful_slots);
        distribute(node.first, left, index, count);
        distribute(node.first + 1, used - left, index, count);
    }

    const Tree& tree_;
    LeafEncoding encoding_;
    double inverse_root_area_ = 1.0;
    LargeArray<Costs> costs_;
    std::uint32_t blocks_ = 0;
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
                         LeafEncoding encoding) {
    const std::size_t count = tree.primitives().size();
    const std::size_t max_count = (std::size_t{1} << kLeafCountShift) / leaf_blocks(encoding, 1);
    if (count >= max_count) {
        throw Error("hierarchy",
                    "cannot hold " + std::to_string(max_count) + " triangles or more",
                    encoding == LeafEncoding::single ? "split the scene"
                                                     : "split the scene, or do not quantise");
    }
    WideTree wide;
    wide.leaf_encoding_ = encoding;
    wide.words_per_block_ = words_per_block(encoding);
    if (count == 0) {
        return wide;
    }
    Collapse collapse(tree, encoding, executor);
    collapse.emit(0);
    wide.triangle_count_ = count;
    wide.set_box(tree.nodes().front().box);
    wide.nodes_.resize(collapse.slots.size());
    wide.words_.resize(wide.words_per_block_ * collapse.blocks() + kPaddingWords);
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
                wide.packed_leaf(node.child[k]) + triangle_ids_offset(encoding, in_leaf);
            if (slot.run_begin != slot.run_end) {
                std::copy_n(tree.primitives().begin() + slot.run_begin, in_leaf, out);
            } else {
                write_primitives(tree, slot.node, out);
            }
            prefetch_triangles({out, in_leaf}, mesh);
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
    // Chunks are short, so that what is prefetched for a chunk is still in the cache when it is
    // read.
    constexpr std::size_t kGrain = 16;
    executor.for_each(wide.nodes_.size(), 64 * kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t begin = first; begin < last; begin += kGrain) {
            const std::size_t end = std::min(begin + kGrain, last);
            for (std::size_t i = begin; i < end; ++i) {
                set_node(i);
            }
            for (std::size_t i = begin; i < end; ++i) {
                for_each_leaf(i, [&](std::uint32_t leaf) {
                    prefetch_vertices(wide.leaf_triangles(leaf), mesh);
                });
            }
            for (std::size_t i = begin; i < end; ++i) {
                for_each_leaf(i, [&](std::uint32_t leaf) {
                    pack_leaf(encoding, wide.packed_leaf(leaf), leaf_count(leaf), mesh);
                });
            }
        }
    });
    if (encoding == LeafEncoding::single) {
        CoordinateRules rules(wide.max_abs_coordinate());
        rules.check(mesh.positions, executor);
        wide.exact_coordinates_ = rules.result();
    }
    return wide;
}

void WideTree::set_box(const Aabb& box) noexcept {
    box_ = box;
    max_abs_coordinate_ = box.max_abs_coordinate();
}

std::span<const std::uint32_t> WideTree::leaf_triangles(std::uint32_t child) const noexcept {
    const std::size_t count = leaf_count(child);
    return {packed_leaf(child) + triangle_ids_offset(leaf_encoding_, count), count};
}

std::size_t WideTree::bytes() const noexcept {
    return nodes_.size() * sizeof(WideNode) + words_.size() * sizeof(std::uint32_t);
}

}  // namespace earshot::bvh
