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
using Children = std::array<std::uint32_t, WideNode::kWidth>;

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
    Collapse(const Tree& tree, Executor& executor) : tree_(tree), costs_(tree.nodes().size() / 2) {
        const double root_area = tree.nodes().front().box.half_area();
        inverse_root_area_ = 1.0 / root_area;
        for_each_bottom_up(tree.nodes(), executor, [&](std::size_t i) {
            const Node& node = tree_.nodes()[i];
            if (!node.is_leaf()) {
                compute_costs(node);
            }
        });
    }

    const Tree& tree() const { return tree_; }

    /// Fills the slots of the wide node of a subtree, from the first on, and returns how many.
    std::size_t fill_slots(std::uint32_t root, Slots& slots) const {
        std::size_t count = 0;
        const Node& node = tree_.nodes()[root];
        if (is_leaf_at(root)) {
            slots[count++] = {root};
        } else if (node.is_leaf()) {
            const std::uint32_t end = node.first + node.count;
            const std::uint32_t middle = node.first + node.count / 2;
            slots[count++] = {root, node.first, middle};
            slots[count++] = {root, middle, end};
        } else {
            const std::uint8_t left = costs_at(node).left_slots_of_node;
            distribute(node.first, left, slots, count);
            distribute(node.first + 1, WideNode::kWidth - left, slots, count);
        }
        return count;
    }

    /// Whether a slot becomes a wide node, and not a packed leaf.
    bool is_inner(const Slot& slot) const {
        return slot.run_begin == slot.run_end && !is_leaf_at(slot.node);
    }

    /// The primitives of a packed leaf.
    std::uint32_t count_of(const Slot& slot) const {
        return slot.run_begin != slot.run_end ? slot.run_end - slot.run_begin : count_at(slot.node);
    }

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

    /// Fills at most `available` slots with the forest of a subtree.
    void distribute(std::uint32_t root,
                    std::size_t available,
                    Slots& slots,
                    std::size_t& count) const {
        const Node& node = tree_.nodes()[root];
        const std::uint8_t left = node.is_leaf() ? 0 : costs_at(node).left_slots[available - 1];
        if (left == 0) {
            slots[count++] = {root};
            return;
        }
        const std::size_t used = std::min<std::size_t>(available, costs_at(node).useful_slots);
        distribute(node.first, left, slots, count);
        distribute(node.first + 1, used - left, slots, count);
    }

    const Tree& tree_;
    double inverse_root_area_ = 1.0;
    LargeArray<Costs> costs_;
};

/// Wide nodes of a subtree, in depth-first order, that one task makes; or, high up in the tree, one
/// wide node, below whose inner slots there are other parts.
struct Part {
    std::uint32_t root = 0;  // of the binary tree
    bool is_single = false;
    std::vector<Slots> slots{};  // per wide node
    /// Per wide node. Of a subtree, nodes and blocks are counted from the part's first; of a single
    /// one, inner slots have the numbers of other parts.
    std::vector<Children> children{};
    std::uint32_t blocks = 0;  // of the packed leaves of a subtree
    std::uint32_t first_node = 0, first_block = 0;
};

/// All wide nodes of a tree, in depth-first order.
class Layout {
public:
    Layout(const Collapse& collapse, LeafEncoding encoding, Executor& executor)
        : collapse_(collapse), encoding_(encoding) {
        // One thread has no use for several parts, and the layout is the same.
        if (executor.threads() > 1) {
            top_ = decompose_into_subtrees(collapse.tree().nodes()).top;
            std::sort(top_.begin(), top_.end());
        }
        divide(0);
        executor.for_each(parts_.size(), 1, [&](std::size_t i, std::size_t) {
            if (!parts_[i].is_single) {
                reserve(parts_[i]);
                emit(parts_[i], parts_[i].root);
            }
        });
        number(0);
    }

    std::span<const Part> parts() const { return parts_; }
    std::size_t nodes() const { return nodes_; }
    std::size_t blocks() const { return blocks_; }

private:
    void reserve(Part& part) const {
        // Wide nodes have six children or so, of four triangles or so.
        const std::size_t nodes = collapse_.tree().nodes().size();
        const std::size_t expected = (top_.empty() ? nodes : kSubtreeTaskSize) / 8 + 1;
        part.slots.reserve(expected);
        part.children.reserve(expected);
    }

    static std::uint32_t leaf_child(std::uint32_t count, std::uint32_t block) {
        return kLeafFlag | (count - 1) << kLeafCountShift | block;
    }
    std::uint32_t blocks_of(std::uint32_t leaf) const {
        return static_cast<std::uint32_t>(leaf_blocks(encoding_, leaf_count(leaf)));
    }

    /// Appends the parts of a subtree of the binary tree and returns the number of the first.
    std::uint32_t divide(std::uint32_t root) {
        const auto index = static_cast<std::uint32_t>(parts_.size());
        parts_.push_back({.root = root});
        if (!std::binary_search(top_.begin(), top_.end(), root)) {
            return index;
        }
        Slots slots;
        Children children;
        children.fill(kNoChild);
        const std::size_t count = collapse_.fill_slots(root, slots);
        for (std::size_t i = 0; i < count; ++i) {
            children[i] = collapse_.is_inner(slots[i])
                              ? divide(slots[i].node)
                              : leaf_child(collapse_.count_of(slots[i]), 0);
        }
        parts_[index].is_single = true;
        parts_[index].slots = {slots};
        parts_[index].children = {children};
        return index;
    }

    /// Appends the wide nodes of a subtree to those of its part and returns the first's number.
    std::uint32_t emit(Part& part, std::uint32_t root) const {
        const auto index = static_cast<std::uint32_t>(part.slots.size());
        part.children.emplace_back().fill(kNoChild);
        const std::size_t count = collapse_.fill_slots(root, part.slots.emplace_back());
        for (std::size_t i = 0; i < count; ++i) {
            const Slot slot = part.slots[index][i];
            if (collapse_.is_inner(slot)) {
                part.children[index][i] = emit(part, slot.node);
            } else {
                const std::uint32_t leaf = leaf_child(collapse_.count_of(slot), part.blocks);
                part.children[index][i] = leaf;
                part.blocks += blocks_of(leaf);
            }
        }
        return index;
    }

    /// Numbers the nodes and blocks of a part and of those below it.
    void number(std::uint32_t index) {
        Part& part = parts_[index];
        part.first_node = nodes_;
        nodes_ += static_cast<std::uint32_t>(part.slots.size());
        if (!part.is_single) {
            part.first_block = blocks_;
            blocks_ += part.blocks;
            return;
        }
        for (std::uint32_t& child : part.children.front()) {
            if (is_leaf(child)) {
                child += blocks_;
                blocks_ += blocks_of(child);
            } else if (child != kNoChild) {
                number(child);
            }
        }
    }

    const Collapse& collapse_;
    LeafEncoding encoding_;
    std::vector<std::size_t> top_;  // nodes of the binary tree above its tasks, sorted
    std::vector<Part> parts_;
    std::uint32_t nodes_ = 0, blocks_ = 0;
};

/// Writes the nodes and packed leaves of parts.
class PartWriter {
public:
    PartWriter(const Tree& tree,
               const Layout& layout,
               const geometry::MeshView& mesh,
               LeafEncoding encoding,
               std::span<WideNode> nodes,
               std::uint32_t* words)
        : tree_(tree),
          layout_(layout),
          mesh_(mesh),
          encoding_(encoding),
          nodes_(nodes),
          words_(words) {}

    /// Some nodes at a time, so that what is prefetched for them is still in the cache when it is
    /// read.
    void write(const Part& part) const {
        constexpr std::size_t kGrain = 8;
        for (std::size_t begin = 0; begin < part.slots.size(); begin += kGrain) {
            const std::size_t end = std::min(begin + kGrain, part.slots.size());
            for (std::size_t i = begin; i < end; ++i) {
                set_node(part, i);
            }
            const std::span<const WideNode> written =
                nodes_.subspan(part.first_node + begin, end - begin);
            for_each_leaf(written, [&](std::uint32_t leaf) {
                prefetch_vertices({triangles_of(leaf), leaf_count(leaf)}, mesh_);
            });
            for_each_leaf(written, [&](std::uint32_t leaf) {
                pack_leaf(encoding_, packed_leaf(leaf), leaf_count(leaf), mesh_);
            });
        }
    }

private:
    template <typename Visit>
    static void for_each_leaf(std::span<const WideNode> nodes, const Visit& visit) {
        for (const WideNode& node : nodes) {
            for (const std::uint32_t child : node.child) {
                if (is_leaf(child)) {
                    visit(child);
                }
            }
        }
    }

    std::uint32_t* packed_leaf(std::uint32_t leaf) const {
        return words_ + words_per_block(encoding_) * leaf_block(leaf);
    }
    std::uint32_t* triangles_of(std::uint32_t leaf) const {
        return packed_leaf(leaf) + triangle_ids_offset(encoding_, leaf_count(leaf));
    }

    std::uint32_t final_child(const Part& part, std::uint32_t child) const {
        if (is_leaf(child)) {
            return child + part.first_block;
        }
        if (child == kNoChild) {
            return child;
        }
        return part.is_single ? layout_.parts()[child].first_node : child + part.first_node;
    }

    void set_node(const Part& part, std::size_t index) const {
        WideNode& node = nodes_[part.first_node + index];
        static const Node kEmpty;
        const Node* boxes[WideNode::kWidth];
        for (std::size_t k = 0; k < WideNode::kWidth; ++k) {
            const Slot& slot = part.slots[index][k];
            boxes[k] = slot.node == kNone ? &kEmpty : &tree_.nodes()[slot.node];
            node.child[k] = final_child(part, part.children[index][k]);
            if (is_leaf(node.child[k])) {
                write_triangles(slot, node.child[k]);
            }
        }
        set_boxes_and_order(node, boxes);
    }

    void write_triangles(const Slot& slot, std::uint32_t leaf) const {
        std::uint32_t* out = triangles_of(leaf);
        if (slot.run_begin != slot.run_end) {
            write_run(slot.run_begin, slot.run_end - slot.run_begin, out);
        } else {
            write_subtree(slot.node, out);
        }
    }

    std::uint32_t* write_subtree(std::uint32_t index, std::uint32_t* out) const {
        const Node& node = tree_.nodes()[index];
        return node.is_leaf() ? write_run(node.first, node.count, out)
                              : write_subtree(node.first + 1, write_subtree(node.first, out));
    }

    std::uint32_t* write_run(std::uint32_t first, std::uint32_t count, std::uint32_t* out) const {
        const std::span<const std::uint32_t> run = tree_.primitives().subspan(first, count);
        prefetch_triangles(run, mesh_);
        return std::copy(run.begin(), run.end(), out);
    }

    const Tree& tree_;
    const Layout& layout_;
    const geometry::MeshView& mesh_;
    LeafEncoding encoding_;
    std::span<WideNode> nodes_;
    std::uint32_t* words_;
};

void check_count(std::size_t count, LeafEncoding encoding) {
    const std::size_t max_count = (std::size_t{1} << kLeafCountShift) / leaf_blocks(encoding, 1);
    if (count >= max_count) {
        throw Error("hierarchy",
                    "cannot hold " + std::to_string(max_count) + " triangles or more",
                    encoding == LeafEncoding::single ? "split the scene"
                                                     : "split the scene, or do not quantise");
    }
}

}  // namespace

WideTree WideTree::build(const Tree& tree,
                         const geometry::MeshView& mesh,
                         Executor& executor,
                         LeafEncoding encoding) {
    const std::size_t count = tree.primitives().size();
    check_count(count, encoding);
    WideTree wide;
    wide.leaf_encoding_ = encoding;
    wide.words_per_block_ = words_per_block(encoding);
    if (count == 0) {
        return wide;
    }
    const Collapse collapse(tree, executor);
    const Layout layout(collapse, encoding, executor);
    wide.triangle_count_ = count;
    wide.set_box(tree.nodes().front().box);
    wide.nodes_.resize(layout.nodes());
    wide.words_.resize(wide.words_per_block_ * layout.blocks() + kPaddingWords);
    std::fill_n(wide.words_.end() - kPaddingWords, kPaddingWords, 0U);
    const PartWriter writer(tree, layout, mesh, encoding, wide.nodes_, wide.words_.data());
    executor.for_each(layout.parts().size(), 1, [&](std::size_t i, std::size_t) {
        writer.write(layout.parts()[i]);
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
