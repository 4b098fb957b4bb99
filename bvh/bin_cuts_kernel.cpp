// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"

#include <algorithm>
#include <initializer_list>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/bin_cuts_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/binning-inl.h"
#include "earshot/bvh/kernels/small_tree-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// A range of a subtree, which stands in refs[side].
struct Run {
    std::uint32_t begin, end;
    std::uint32_t side;
    std::uint32_t depth;

    HWY_INLINE std::uint32_t size() const { return end - begin; }
};

class SubtreeBuilder {
public:
    SubtreeBuilder(const BuildRange& subtree,
                   const SplitRule& rule,
                   RawNode* nodes,
                   std::uint32_t* primitives)
        : refs_{subtree.refs[0], subtree.refs[1]},
          rule_(rule),
          output_{nodes, 1, primitives, subtree.begin} {}

    std::uint32_t node_count() const { return output_.node_count; }

    /// Builds the tree over a run into nodes[node] and what follows the nodes there are.
    void build(std::uint32_t node, const Run& run, Box box, Box centres) {
        const std::uint32_t size = run.size();
        PrimRef* const refs = refs_[run.side] + run.begin;
        if (size == 1) {
            write_leaf(node, run, box);
            return;
        }
        if (rule_.spatial_median && size <= rule_.max_leaf_size) {
            write_leaf(node, run, box);
            return;
        }
        if (size <= kSmallTree && !rule_.spatial_median) {
            SmallTree(refs, size, rule_, output_).write(node, box);
            return;
        }
        if (run.depth >= kMedianSplitDepth) {
            if (size <= rule_.max_leaf_size) {
                write_leaf(node, run, box);
            } else {
                cut_in_half(node, run, box);
            }
            return;
        }
        const Binning binning =
            rule_.spatial_median ? make_halves(box) : make_binning(centres, size);
        fill(refs, size, binning, bins_, spare_bins_);
        const Split split = best_split(bins_, binning);
        if (size <= rule_.max_leaf_size) {
            const float area = half_area(box);
            if (!(rule_.traversal_cost * area + split.cost < static_cast<float>(size) * area)) {
                write_leaf(node, run, box);
                return;
            }
        }
        if (split.first_right_bin == 0) {
            cut_in_half(node, run, box);
        } else {
            cut(node, run, box, binning, split);
        }
    }

private:
    void write_leaf(std::uint32_t node, const Run& run, Box box) {
        for (std::uint32_t i = run.begin; i < run.end; ++i) {
            output_.primitives[i] = primitive_index(refs_[run.side][i]);
        }
        output_.primitive_count = run.end;
        store_node(box, run.begin, run.size(), output_.nodes[node]);
    }

    void cut(
        std::uint32_t node, const Run& run, Box box, const Binning& binning, const Split& split) {
        const std::uint32_t middle = run.begin + split.left_count;
        const std::uint32_t side = 1 - run.side;
        const Centres centres = part_stably({refs_[run.side] + run.begin,
                                             run.size(),
                                             refs_[side] + run.begin,
                                             refs_[side] + middle},
                                            binning,
                                            split);
        const Box left = load_box(split.box[0]);
        const Box right = load_box(split.box[1]);
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        build(children, {run.begin, middle, side, run.depth + 1}, left, centres.left);
        build(children + 1, {middle, run.end, side, run.depth + 1}, right, centres.right);
    }

    void cut_in_half(std::uint32_t node, const Run& run, Box box) {
        BuildBox bounds;
        store_box(box, bounds);
        PrimRef* const refs = refs_[run.side];
        const std::size_t left = split_at_median(refs + run.begin, run.size(), bounds);
        const std::uint32_t middle = run.begin + static_cast<std::uint32_t>(left);
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        build_bounded(children, {run.begin, middle, run.side, run.depth + 1});
        build_bounded(children + 1, {middle, run.end, run.side, run.depth + 1});
    }

    void build_bounded(std::uint32_t node, const Run& run) {
        Box box = nothing(), centres = nothing();
        for (std::uint32_t i = run.begin; i < run.end; ++i) {
            const Box next_box = load_box(refs_[run.side][i]);
            box = join(box, next_box);
            centres = join(centres, centre_box(next_box));
        }
        build(node, run, box, centres);
    }

    PrimRef* refs_[2];
    SplitRule rule_;
    Output output_;
    Bins bins_, spare_bins_;
};

std::uint32_t subtree(const BuildRange& task,
                      const SplitRule& rule,
                      RawNode* nodes,
                      std::uint32_t* primitives) {
    SubtreeBuilder builder(task, rule, nodes, primitives);
    builder.build(0,
                  {task.begin, task.end, task.side, task.depth},
                  load_box(task.bounds.box),
                  load_box(task.bounds.centroids));
    return builder.node_count();
}

void refer_into(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    refer_to(boxes, first, count, refs, bounds);
}

Binning make_binning_of(const SplitRule& rule, const Bounds& bounds, std::size_t count) {
    return rule.spatial_median ? make_halves(load_box(bounds.box))
                               : make_binning(load_box(bounds.centroids), count);
}

void fill_from(const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins) {
    Bins spare;
    fill(refs, count, binning, bins, spare);
}

void join_all(const Bins& more, const Binning& binning, Bins& bins) {
    add_bins(more, binning, bins);
}

Split split_between(const Bins& bins, const Binning& binning) {
    return best_split(bins, binning);
}

void part_into(const PartitionTask& parting,
               const Binning& binning,
               const Split& split,
               BuildBox* centroids) {
    const Centres both = part_stably(parting, binning, split);
    store_box(both.left, centroids[0]);
    store_box(both.right, centroids[1]);
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(refer_into);
HWY_EXPORT(make_binning_of);
HWY_EXPORT(fill_from);
HWY_EXPORT(join_all);
HWY_EXPORT(split_between);
HWY_EXPORT(part_into);
HWY_EXPORT(subtree);

void make_prim_refs(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    HWY_DYNAMIC_DISPATCH(refer_into)(boxes, first, count, refs, bounds);
}

Binning choose_binning(const SplitRule& rule, const Bounds& bounds, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(make_binning_of)(rule, bounds, count);
}

void fill_bins(const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins) {
    HWY_DYNAMIC_DISPATCH(fill_from)(refs, count, binning, bins);
}

void merge_bins(const Bins& more, const Binning& binning, Bins& bins) {
    HWY_DYNAMIC_DISPATCH(join_all)(more, binning, bins);
}

Split find_split(const Bins& bins, const Binning& binning) {
    return HWY_DYNAMIC_DISPATCH(split_between)(bins, binning);
}

void partition(const PartitionTask& parting,
               const Binning& binning,
               const Split& split,
               BuildBox* centroids) {
    HWY_DYNAMIC_DISPATCH(part_into)(parting, binning, split, centroids);
}

std::uint32_t build_subtree(const BuildRange& task,
                            const SplitRule& rule,
                            RawNode* nodes,
                            std::uint32_t* primitives) {
    return HWY_DYNAMIC_DISPATCH(subtree)(task, rule, nodes, primitives);
}

}  // namespace earshot::bvh
#endif
