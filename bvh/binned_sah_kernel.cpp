// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"

#include <algorithm>
#include <initializer_list>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/binned_sah_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/binning-inl.h"
#include "earshot/bvh/kernels/small_tree-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// A range of references. They are in refs_[buffer]; the other buffer is free.
struct Range {
    std::uint32_t begin, end;
    std::uint32_t buffer;
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

    /// Builds the tree over a range: its root is nodes[node], its other nodes are appended.
    void build(std::uint32_t node, const Range& range, Box box, Box centroids) {
        const std::uint32_t size = range.size();
        PrimRef* const refs = refs_[range.buffer] + range.begin;
        if (size == 1) {
            write_leaf(node, range, box);
            return;
        }
        if (rule_.spatial_median && size <= rule_.max_leaf_size) {
            write_leaf(node, range, box);
            return;
        }
        if (size <= kMaxSmallTreeRefs && !rule_.spatial_median) {
            OptimalSmallTree(refs, size, rule_, output_).write(node, box);
            return;
        }
        if (range.depth >= kMedianSplitDepth) {
            if (size <= rule_.max_leaf_size) {
                write_leaf(node, range, box);
            } else {
                split_range_at_median(node, range, box);
            }
            return;
        }
        const Binning binning =
            rule_.spatial_median ? make_spatial_median_binning(box) : make_binning(centroids, size);
        fill(refs, size, binning, bins_, scratch_bins_);
        const Split split = best_split(bins_, binning);
        if (size <= rule_.max_leaf_size) {
            const float area = half_area(box);
            if (!(rule_.traversal_cost * area + split.cost < static_cast<float>(size) * area)) {
                write_leaf(node, range, box);
                return;
            }
        }
        if (split.first_right_bin == 0) {
            split_range_at_median(node, range, box);
        } else {
            split_range(node, range, box, binning, split);
        }
    }

private:
    void write_leaf(std::uint32_t node, const Range& range, Box box) {
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            output_.primitives[i] = primitive_index(refs_[range.buffer][i]);
        }
        output_.primitive_count = range.end;
        store_node(box, range.begin, range.size(), output_.nodes[node]);
    }

    void split_range(std::uint32_t node,
                     const Range& range,
                     Box box,
                     const Binning& binning,
                     const Split& split) {
        const std::uint32_t middle = range.begin + split.left_count;
        const std::uint32_t other = 1 - range.buffer;
        const CentroidBounds centroids = partition_stable({refs_[range.buffer] + range.begin,
                                                           range.size(),
                                                           refs_[other] + range.begin,
                                                           refs_[other] + middle},
                                                          binning,
                                                          split);
        const Box left = load_box(split.box[0]);
        const Box right = load_box(split.box[1]);
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        build(children, {range.begin, middle, other, range.depth + 1}, left, centroids.left);
        build(children + 1, {middle, range.end, other, range.depth + 1}, right, centroids.right);
    }

    void split_range_at_median(std::uint32_t node, const Range& range, Box box) {
        BuildBox bounds;
        store_box(box, bounds);
        PrimRef* const refs = refs_[range.buffer];
        const std::size_t left = split_at_median(refs + range.begin, range.size(), bounds);
        const std::uint32_t middle = range.begin + static_cast<std::uint32_t>(left);
        const std::uint32_t children = output_.add_children();
        store_node(box, children, 0, output_.nodes[node]);
        build_with_bounds(children, {range.begin, middle, range.buffer, range.depth + 1});
        build_with_bounds(children + 1, {middle, range.end, range.buffer, range.depth + 1});
    }

    void build_with_bounds(std::uint32_t node, const Range& range) {
        Box box = empty_box(), centroids = empty_box();
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const Box next_box = load_box(refs_[range.buffer][i]);
            box = merge(box, next_box);
            centroids = merge(centroids, centroid_box(next_box));
        }
        build(node, range, box, centroids);
    }

    PrimRef* refs_[2];
    SplitRule rule_;
    Output output_;
    Bins bins_, scratch_bins_;
};

std::uint32_t subtree(const BuildRange& task,
                      const SplitRule& rule,
                      RawNode* nodes,
                      std::uint32_t* primitives) {
    SubtreeBuilder builder(task, rule, nodes, primitives);
    builder.build(0,
                  {task.begin, task.end, task.buffer, task.depth},
                  load_box(task.bounds.box),
                  load_box(task.bounds.centroids));
    return builder.node_count();
}

void make_refs_of(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    make_refs(boxes, first, count, refs, bounds);
}

Binning make_binning_of(const SplitRule& rule, const Bounds& bounds, std::size_t count) {
    return rule.spatial_median ? make_spatial_median_binning(load_box(bounds.box))
                               : make_binning(load_box(bounds.centroids), count);
}

void fill_bins_of(const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins) {
    Bins scratch;
    fill(refs, count, binning, bins, scratch);
}

void merge_all(const Bins& other, const Binning& binning, Bins& bins) {
    add_bins(other, binning, bins);
}

Split split_of(const Bins& bins, const Binning& binning) {
    return best_split(bins, binning);
}

void partition_into(const PartitionTask& task,
                    const Binning& binning,
                    const Split& split,
                    BuildBox* centroids) {
    const CentroidBounds bounds = partition_stable(task, binning, split);
    store_box(bounds.left, centroids[0]);
    store_box(bounds.right, centroids[1]);
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(make_refs_of);
HWY_EXPORT(make_binning_of);
HWY_EXPORT(fill_bins_of);
HWY_EXPORT(merge_all);
HWY_EXPORT(split_of);
HWY_EXPORT(partition_into);
HWY_EXPORT(subtree);

void make_prim_refs(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    HWY_DYNAMIC_DISPATCH(make_refs_of)(boxes, first, count, refs, bounds);
}

Binning choose_binning(const SplitRule& rule, const Bounds& bounds, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(make_binning_of)(rule, bounds, count);
}

void fill_bins(const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins) {
    HWY_DYNAMIC_DISPATCH(fill_bins_of)(refs, count, binning, bins);
}

void merge_bins(const Bins& other, const Binning& binning, Bins& bins) {
    HWY_DYNAMIC_DISPATCH(merge_all)(other, binning, bins);
}

Split find_split(const Bins& bins, const Binning& binning) {
    return HWY_DYNAMIC_DISPATCH(split_of)(bins, binning);
}

void partition(const PartitionTask& task,
               const Binning& binning,
               const Split& split,
               BuildBox* centroids) {
    HWY_DYNAMIC_DISPATCH(partition_into)(task, binning, split, centroids);
}

std::uint32_t build_subtree(const BuildRange& task,
                            const SplitRule& rule,
                            RawNode* nodes,
                            std::uint32_t* primitives) {
    return HWY_DYNAMIC_DISPATCH(subtree)(task, rule, nodes, primitives);
}

}  // namespace earshot::bvh
#endif
