// SPDX-License-Identifier: MIT
//
// Binning, sweep and partition of ranges of boxes: the steps of binned_sah.h, compiled once per
// instruction set.

#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/kernels/box-inl.h"

#include <algorithm>

#if defined(EARSHOT_BVH_KERNELS_BINNING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_BINNING_INL_H
#undef EARSHOT_BVH_KERNELS_BINNING_INL_H
#else
#define EARSHOT_BVH_KERNELS_BINNING_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// 2^23: floats of this size are integers, so that adding it rounds a number to the nearest
/// integer, ties to even, and leaves the integer in the lowest bits.
constexpr float kRounder = 8388608.0F;

HWY_INLINE Binning make_binning(Box centroids, std::size_t count) {
    // Most ranges are small, and the sweep over the bins dominates their time.
    const std::size_t bins = count < 16 * (kMaxBins - 6) ? 6 + count / 16 : kMaxBins;
    const Float4 width = extent(centroids);
    const Float4 scale = Float4(static_cast<float>(bins - 1)) / width;
    // An axis whose width is 0, or so small that the quotient overflows, is not split.
    const Float4 none = Float4(0.0F);
    const Float4 not_tiny = select(scale < Float4(kHighest), scale, none);
    Binning binning;
    (none - low(centroids)).store(binning.lower);
    select(none < width, not_tiny, none).store(binning.scale);
    binning.lower[3] = 0.0F;
    binning.scale[3] = 0.0F;
    binning.bins = static_cast<std::uint32_t>(bins);
    return binning;
}

/// Two bins along the longest side of a box, which meet in its middle.
HWY_INLINE Binning make_spatial_median_binning(Box box) {
    alignas(16) float widths[4], lower[4];
    extent(box).store(widths);
    low(box).store(lower);
    const std::size_t first_two = widths[1] > widths[0] ? 1 : 0;
    const std::size_t axis = widths[2] > widths[first_two] ? 2 : first_two;
    // Centroids are doubled, and so is the side.
    const float scale = 1.0F / (2.0F * widths[axis]);
    Binning binning{};
    binning.lower[axis] = -2.0F * lower[axis];
    binning.scale[axis] = scale < kHighest ? scale : 0.0F;
    binning.bins = 2;
    return binning;
}

HWY_INLINE void clear(const Binning& binning, Bins& bins) {
    for (std::size_t i = 0; i < binning.bins; ++i) {
        Bin& bin = bins.at[i];
        for (BuildBox& box : bin.boxes) {
            store_box(empty_box(), box);
        }
        std::fill_n(bin.counts, 4, 0);
    }
}

/// Makes references to boxes, given as six floats each, whose indices count from `first`, and
/// computes their bounds and the bounds of their centroids.
HWY_INLINE void make_refs(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    const Float4 max_coordinate = Float4(kMaxCoordinate);
    const Float4 zero = Float4(0.0F);
    const Float4 min_coordinate = zero - max_coordinate;
    const auto clamp = [&](Float4 position) {
        return max(min(position, max_coordinate), min_coordinate);
    };
    Box box = empty_box(), centroids = empty_box();
    for (std::size_t i = 0; i < count; ++i) {
        const float* const bounds_of_box = boxes + 6 * i;
        const auto index = first + static_cast<std::uint32_t>(i);
        // Subtracting from and adding to zero leaves no negative zero.
        (zero - clamp(Float4::load_unaligned(bounds_of_box))).store(refs[i].low);
        (clamp(rotate_by_one(Float4::load_unaligned(bounds_of_box + 2))) + zero)
            .store(refs[i].high);
        refs[i].low[3] = static_cast<float>(index & 0xFFFFU);
        refs[i].high[3] = static_cast<float>(index >> 16U);
        const Box ref = load_box(refs[i]);
        box = merge(box, ref);
        centroids = merge(centroids, centroid_box(ref));
    }
    store_box(box, bounds.box);
    store_box(centroids, bounds.centroids);
}

HWY_INLINE void add_to_bin(const PrimRef& ref, Float4 lower, Float4 scale, Bins& bins) {
    const Box box = load_box(ref);
    const Float4 centroid = Float4::load(ref.high) - Float4::load(ref.low);
    const Float4 position = (centroid - lower) * scale + Float4(kRounder);
    std::uint32_t bin_indices[3];
    store_masked_bits(position, static_cast<std::int32_t>(kMaxBins - 1), bin_indices);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Bin& bin = bins.at[bin_indices[axis]];
        store_box(merge(load_box(bin.boxes[axis]), box), bin.boxes[axis]);
        ++bin.counts[axis];
    }
}

/// Merges the boxes of `other` into those of `bins` and adds its counts.
HWY_INLINE void add_bins(const Bins& other, const Binning& binning, Bins& bins) {
    for (std::size_t i = 0; i < binning.bins; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            BuildBox& box = bins.at[i].boxes[axis];
            store_box(merge(load_box(box), load_box(other.at[i].boxes[axis])), box);
            bins.at[i].counts[axis] += other.at[i].counts[axis];
        }
    }
}

/// Counts references per bin and merges their boxes there. `scratch` is scratch memory.
HWY_INLINE void fill(
    const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins, Bins& scratch) {
    // Consecutive references tend to share a bin, and a load right after a store to the same bin
    // stalls. So the two halves of a large range are binned alternately into two sets of bins.
    constexpr std::size_t kMinRefsForTwoSets = 128;
    const Float4 lower = Float4::load(binning.lower);
    const Float4 scale = Float4::load(binning.scale);
    clear(binning, bins);
    std::size_t i = 0;
    if (count >= kMinRefsForTwoSets) {
        clear(binning, scratch);
        const std::size_t half = count / 2;
        for (; i < half; ++i) {
            add_to_bin(refs[i], lower, scale, bins);
            add_to_bin(refs[i + half], lower, scale, scratch);
        }
        add_bins(scratch, binning, bins);
        i = 2 * half;
    }
    for (; i < count; ++i) {
        add_to_bin(refs[i], lower, scale, bins);
    }
}

/// Boxes and counts that grow bin by bin, along three axes at once.
struct Sweep {
    Box boxes[3];
    Float4 counts;

    HWY_INLINE Sweep() : boxes{empty_box(), empty_box(), empty_box()}, counts(Float4(0.0F)) {}
    HWY_INLINE void include(const Bin& bin) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            boxes[axis] = merge(boxes[axis], load_box(bin.boxes[axis]));
        }
        counts = counts + load_int32(bin.counts);
    }
    /// NaN where no box is included yet.
    HWY_INLINE Float4 cost() const {
        const Float4 last = extent(boxes[2]);
        const Float4 areas = half_areas(transpose(extent(boxes[0]), extent(boxes[1]), last, last));
        return areas * counts;
    }
};

/// Computes the number of primitives on the left of a split and the boxes of both sides.
HWY_INLINE void set_sides(const Bins& bins, const Binning& binning, Split& split) {
    const std::uint32_t axis = split.axis;
    std::int32_t count = 0;
    Box left = empty_box(), right = empty_box();
    for (std::uint32_t i = 0; i < split.first_right_bin; ++i) {
        left = merge(left, load_box(bins.at[i].boxes[axis]));
        count += bins.at[i].counts[axis];
    }
    for (std::uint32_t i = split.first_right_bin; i < binning.bins; ++i) {
        right = merge(right, load_box(bins.at[i].boxes[axis]));
    }
    split.left_count = static_cast<std::uint32_t>(count);
    store_box(left, split.box[0]);
    store_box(right, split.box[1]);
}

// Wald 2007, sections 3.1 to 3.3: bins of the centroids, swept from both sides.
HWY_INLINE Split best_split(const Bins& bins, const Binning& binning) {
    alignas(16) float right_costs[kMaxBins][4];
    Sweep right;
    for (std::size_t i = binning.bins; i-- > 1;) {
        right.include(bins.at[i]);
        right.cost().store(right_costs[i]);
    }
    Float4 best = Float4(kHighest);
    Float4 best_bin = Float4(0.0F);
    Sweep left;
    for (std::size_t i = 1; i < binning.bins; ++i) {
        left.include(bins.at[i - 1]);
        const Float4 cost = left.cost() + Float4::load(right_costs[i]);
        const Float4::Mask is_better = cost < best;
        best = select(is_better, cost, best);
        best_bin = select(is_better, Float4(static_cast<float>(i)), best_bin);
    }
    alignas(16) float costs[4], bin_indices[4];
    best.store(costs);
    best_bin.store(bin_indices);
    Split split{};
    split.cost = kHighest;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        if (costs[axis] < split.cost) {
            split.cost = costs[axis];
            split.axis = axis;
            split.first_right_bin = static_cast<std::uint32_t>(bin_indices[axis]);
        }
    }
    if (split.first_right_bin != 0) {
        set_sides(bins, binning, split);
    }
    return split;
}

/// The bounds of the centroids on both sides of a split.
struct CentroidBounds {
    Box left, right;
};

HWY_INLINE CentroidBounds partition_stable(const PartitionTask& task,
                                           const Binning& binning,
                                           const Split& split) {
    const std::size_t axis = split.axis;
    const float lower = binning.lower[axis];
    const float scale = binning.scale[axis];
    const float first_right = kRounder + static_cast<float>(split.first_right_bin);
    CentroidBounds centroids = {empty_box(), empty_box()};
    const std::ptrdiff_t right_offset = task.right - task.left;
    std::ptrdiff_t left = 0;
    for (std::size_t i = 0; i < task.count; ++i) {
        const PrimRef& ref = task.refs[i];
        const Box box = load_box(ref);
        const float position = (doubled_centroid(ref, axis) - lower) * scale + kRounder;
        // A branch on the side would often be mispredicted, so there is none.
        const std::ptrdiff_t left_step = position < first_right ? 1 : 0;
        const std::ptrdiff_t right = right_offset + static_cast<std::ptrdiff_t>(i) - left;
        store_box(box, task.left[right ^ ((right ^ left) & -left_step)]);
        left += left_step;
        const Float8::Mask is_left = Float8(position) < Float8(first_right);
        const Box centroid = centroid_box(box);
        centroids.left = merge(centroids.left, select(is_left, centroid, empty_box()));
        centroids.right = merge(centroids.right, select(is_left, empty_box(), centroid));
    }
    return centroids;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
