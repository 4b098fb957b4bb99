// SPDX-License-Identifier: MIT
//
// Trees of minimal SAH cost over up to four boxes, compiled once per instruction set. Two thirds of
// all nodes belong to such trees, and for so few boxes an exhaustive search is faster than binning.

#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/kernels/box-inl.h"

#if defined(EARSHOT_BVH_KERNELS_SMALL_TREE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_SMALL_TREE_INL_H
#undef EARSHOT_BVH_KERNELS_SMALL_TREE_INL_H
#else
#define EARSHOT_BVH_KERNELS_SMALL_TREE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

constexpr std::size_t kMaxSmallTreeRefs = 4;

/// Half areas of the sets of up to three of four boxes. Lane i of `pairs` is of boxes i and i + 1,
/// of `cross` i and i + 2, of `triples` i, i + 1 and i + 2; all counted around the end.
struct SetAreas {
    Float4 singles, pairs, cross, triples;
};

HWY_INLINE SetAreas areas_of_sets(const Box boxes[kMaxSmallTreeRefs]) {
    const ThreeAxes lows = transpose(low(boxes[0]), low(boxes[1]), low(boxes[2]), low(boxes[3]));
    const ThreeAxes highs =
        transpose(high(boxes[0]), high(boxes[1]), high(boxes[2]), high(boxes[3]));
    ThreeAxes single, pair, cross, triple;  // extents
    const auto along =
        [](Float4 low, Float4 high, Float4& one, Float4& two, Float4& over, Float4& three) {
            const Float4 low_pair = max(low, rotate_by_one(low));
            const Float4 high_pair = max(high, rotate_by_one(high));
            one = low + high;
            two = low_pair + high_pair;
            over = max(low, rotate_by_two(low)) + max(high, rotate_by_two(high));
            three = max(low_pair, rotate_by_two(low)) + max(high_pair, rotate_by_two(high));
        };
    along(lows.x, highs.x, single.x, pair.x, cross.x, triple.x);
    along(lows.y, highs.y, single.y, pair.y, cross.y, triple.y);
    along(lows.z, highs.z, single.z, pair.z, cross.z, triple.z);
    // Finite, so that no product with them is not a number.
    const auto area = [](const ThreeAxes& extents) {
        return min(half_areas(extents), Float4(kHighest));
    };
    return {area(single), area(pair), area(cross), area(triple)};
}

/// The SAH cost of the best tree over each set, and a bit per lane where that tree is a leaf.
struct SetCosts {
    alignas(16) float singles[4], pairs[4], cross[4], triples[4];
    unsigned pair_leaves, cross_leaves, triple_leaves;
};

/// The lower of the costs of a split and of a leaf; ties become leaves.
HWY_INLINE Float4 cheaper(Float4 split, Float4 leaf, bool may_be_leaf, unsigned& leaves) {
    if (!may_be_leaf) {
        leaves = 0;
        return split;
    }
    leaves = bits(leaf <= split);
    return min(split, leaf);
}

HWY_INLINE SetCosts costs_of_sets(const SetAreas& areas, const SplitRule& rule) {
    const Float4 traversal = Float4(rule.traversal_cost);
    const auto split = [&](Float4 area, Float4 below) { return traversal * area + below; };
    const Float4 one = areas.singles;
    SetCosts costs;
    const Float4 pairs = cheaper(split(areas.pairs, one + rotate_by_one(one)),
                                 Float4(2.0F) * areas.pairs,
                                 rule.max_leaf_size >= 2,
                                 costs.pair_leaves);
    const Float4 cross = cheaper(split(areas.cross, one + rotate_by_two(one)),
                                 Float4(2.0F) * areas.cross,
                                 rule.max_leaf_size >= 2,
                                 costs.cross_leaves);
    const Float4 first = one + rotate_by_one(pairs);
    const Float4 middle = rotate_by_one(one) + cross;
    const Float4 last = rotate_by_two(one) + pairs;
    const Float4 triples = cheaper(split(areas.triples, min(min(first, middle), last)),
                                   Float4(3.0F) * areas.triples,
                                   rule.max_leaf_size >= 3,
                                   costs.triple_leaves);
    one.store(costs.singles);
    pairs.store(costs.pairs);
    cross.store(costs.cross);
    triples.store(costs.triples);
    return costs;
}

/// The arrays that nodes and primitive indices are written to.
struct Output {
    RawNode* nodes;
    std::uint32_t node_count;
    std::uint32_t* primitives;
    std::uint32_t primitive_count;

    HWY_INLINE std::uint32_t add_children() {
        node_count += 2;
        return node_count - 2;
    }
};

/// Writes the best tree over two to four references.
class OptimalSmallTree {
public:
    HWY_INLINE OptimalSmallTree(const PrimRef* refs,
                                std::uint32_t count,
                                const SplitRule& rule,
                                Output& output)
        : refs_(refs), count_(count), rule_(rule), output_(output) {
        for (std::uint32_t i = 0; i < kMaxSmallTreeRefs; ++i) {
            boxes_[i] = load_box(refs[i < count ? i : count - 1]);
        }
        costs_ = costs_of_sets(areas_of_sets(boxes_), rule);
    }

    HWY_INLINE void write(std::uint32_t node, Box box) {
        if (count_ == 2) {
            write_pair(node, 0, 1, costs_.pair_leaves & 1U);
        } else if (count_ == 3) {
            write_triple(node, 0);
        } else {
            write_all(node, box);
        }
    }

private:
    /// A leaf of these boxes.
    HWY_INLINE void write_leaf(std::uint32_t node, Box box, std::initializer_list<unsigned> lanes) {
        const std::uint32_t first = output_.primitive_count;
        for (const unsigned lane : lanes) {
            output_.primitives[output_.primitive_count++] = primitive_index(refs_[lane]);
        }
        store_node(box, first, output_.primitive_count - first, output_.nodes[node]);
    }

    HWY_INLINE void write_single(std::uint32_t node, unsigned lane) {
        write_leaf(node, boxes_[lane], {lane});
    }

    void write_pair(std::uint32_t node, unsigned a, unsigned b, bool is_leaf) {
        const Box box = merge(boxes_[a], boxes_[b]);
        if (is_leaf) {
            write_leaf(node, box, {a, b});
            return;
        }
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        write_single(children, a);
        write_single(children + 1, b);
    }

    /// Of boxes i, i + 1 and i + 2, around the end.
    void write_triple(std::uint32_t node, unsigned i) {
        const unsigned j = (i + 1) % 4, k = (i + 2) % 4;
        const Box box = merge(merge(boxes_[i], boxes_[j]), boxes_[k]);
        if ((costs_.triple_leaves >> i & 1U) != 0) {
            write_leaf(node, box, {i, j, k});
            return;
        }
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        const float first = costs_.singles[i] + costs_.pairs[j];
        const float middle = costs_.singles[j] + costs_.cross[i];
        const float last = costs_.singles[k] + costs_.pairs[i];
        if (first <= middle && first <= last) {
            write_single(children, i);
            write_pair(children + 1, j, k, costs_.pair_leaves >> j & 1U);
        } else if (middle <= last) {
            write_single(children, j);
            write_pair(children + 1, i, k, costs_.cross_leaves >> i & 1U);
        } else {
            write_single(children, k);
            write_pair(children + 1, i, j, costs_.pair_leaves >> i & 1U);
        }
    }

    void write_all(std::uint32_t node, Box box) {
        const float* const one = costs_.singles;
        const float pair_splits[3] = {costs_.pairs[0] + costs_.pairs[2],
                                      costs_.pairs[1] + costs_.pairs[3],
                                      costs_.cross[0] + costs_.cross[1]};
        unsigned choice =
            0;  // below 4: the box that is a child alone; from 4: a split into two pairs
        float best = one[0] + costs_.triples[1];
        for (unsigned i = 1; i < 4; ++i) {
            const float cost = one[i] + costs_.triples[(i + 1) % 4];
            choice = cost < best ? i : choice;
            best = cost < best ? cost : best;
        }
        for (unsigned i = 0; i < 3; ++i) {
            choice = pair_splits[i] < best ? 4 + i : choice;
            best = pair_splits[i] < best ? pair_splits[i] : best;
        }
        const float area = half_area(box);
        if (rule_.max_leaf_size >= 4 && !(rule_.traversal_cost * area + best < 4.0F * area)) {
            write_leaf(node, box, {0, 1, 2, 3});
            return;
        }
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        if (choice < 4) {
            write_single(children, choice);
            write_triple(children + 1, (choice + 1) % 4);
        } else if (choice < 6) {
            const unsigned i = choice - 4;
            write_pair(children, i, i + 1, costs_.pair_leaves >> i & 1U);
            write_pair(children + 1, i + 2, (i + 3) % 4, costs_.pair_leaves >> (i + 2) & 1U);
        } else {
            write_pair(children, 0, 2, costs_.cross_leaves & 1U);
            write_pair(children + 1, 1, 3, costs_.cross_leaves >> 1U & 1U);
        }
    }

    const PrimRef* refs_;
    std::uint32_t count_;
    const SplitRule& rule_;
    Output& output_;
    Box boxes_[kMaxSmallTreeRefs];
    SetCosts costs_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
