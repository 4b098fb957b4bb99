// SPDX-License-Identifier: MIT
//
// Binning, sweeping and parting of ranges of boxes; the steps of bin_cuts.h, compiled once per
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

/// 2^23: floats from here on are whole numbers, so that adding it rounds to the nearest, ties to
/// even, and leaves the number in the lowest bits.
constexpr float kRounder = 8388608.0F;

HWY_INLINE Binning make_binning(Box centres, std::size_t count) {
    // Most ranges are small, and their time is the sweep's.
    const std::size_t bins = count < 16 * (kMaxBins - 6) ? 6 + count / 16 : kMaxBins;
    const Float4 width = extent(centres);
    const Float4 scale = Float4(static_cast<float>(bins - 1)) / width;
    // Of widths so small that the quotient overflows, and of none, there is nothing to cut.
    const Float4 none = Float4(0.0F);
    const Float4 not_tiny = select(scale < Float4(kHighest), scale, none);
    Binning binning;
    (none - low(centres)).store(binning.lower);
    select(none < width, not_tiny, none).store(binning.scale);
    binning.lower[3] = 0.0F;
    binning.scale[3] = 0.0F;
    binning.bins = static_cast<std::uint32_t>(bins);
    return binning;
}

/// Two bins along the longest side, which meet in its middle.
HWY_INLINE Binning make_halves(Box box) {
    alignas(16) float widths[4], lower[4];
    extent(box).store(widths);
    low(box).store(lower);
    const std::size_t first_two = widths[1] > widths[0] ? 1 : 0;
    const std::size_t axis = widths[2] > widths[first_two] ? 2 : first_two;
    // Centres are doubled, and so is the side.
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
            store_box(nothing(), box);
        }
        std::fill_n(bin.counts, 4, 0);
    }
}

/// Makes references to boxes, given as six floats each, whose indices count from `first`, and joins
/// their bounds and those of their centres.
HWY_INLINE void refer_to(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds) {
    const Float4 farthest = Float4(kMaxCoordinate);
    const Float4 zero = Float4(0.0F);
    const Float4 nearest = zero - farthest;
    const auto clamp = [&](Float4 place) { return max(min(place, farthest), nearest); };
    Box box = nothing(), centres = nothing();
    for (std::size_t i = 0; i < count; ++i) {
        const float* const numbers = boxes + 6 * i;
        const auto index = first + static_cast<std::uint32_t>(i);
        // Subtracting from and adding to zero leaves no negative zero.
        (zero - clamp(Float4::load_unaligned(numbers))).store(refs[i].low);
        (clamp(rotate_by_one(Float4::load_unaligned(numbers + 2))) + zero).store(refs[i].high);
        refs[i].low[3] = static_cast<float>(index & 0xFFFFU);
        refs[i].high[3] = static_cast<float>(index >> 16U);
        const Box ref = load_box(refs[i]);
        box = join(box, ref);
        centres = join(centres, centre_box(ref));
    }
    store_box(box, bounds.box);
    store_box(centres, bounds.centroids);
}

HWY_INLINE void put(const PrimRef& ref, Float4 lower, Float4 scale, Bins& bins) {
    const Box box = load_box(ref);
    const Float4 centre = Float4::load(ref.high) - Float4::load(ref.low);
    const Float4 place = (centre - lower) * scale + Float4(kRounder);
    std::uint32_t places[3];
    store_masked_bits(place, static_cast<std::int32_t>(kMaxBins - 1), places);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Bin& bin = bins.at[places[axis]];
        store_box(join(load_box(bin.boxes[axis]), box), bin.boxes[axis]);
        ++bin.counts[axis];
    }
}

/// Adds what is in `more` to `bins`.
HWY_INLINE void add_bins(const Bins& more, const Binning& binning, Bins& bins) {
    for (std::size_t i = 0; i < binning.bins; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            BuildBox& box = bins.at[i].boxes[axis];
            store_box(join(load_box(box), load_box(more.at[i].boxes[axis])), box);
            bins.at[i].counts[axis] += more.at[i].counts[axis];
        }
    }
}

/// Counts and joins references into bins; `spare` is for its own use.
HWY_INLINE void fill(
    const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins, Bins& spare) {
    // Neighbours tend to share bins, and what was just stored loads late. So large ranges are
    // binned from two ends into two sets of bins.
    constexpr std::size_t kWorthTwoSets = 128;
    const Float4 lower = Float4::load(binning.lower);
    const Float4 scale = Float4::load(binning.scale);
    clear(binning, bins);
    std::size_t i = 0;
    if (count >= kWorthTwoSets) {
        clear(binning, spare);
        const std::size_t half = count / 2;
        for (; i < half; ++i) {
            put(refs[i], lower, scale, bins);
            put(refs[i + half], lower, scale, spare);
        }
        add_bins(spare, binning, bins);
        i = 2 * half;
    }
    for (; i < count; ++i) {
        put(refs[i], lower, scale, bins);
    }
}

/// Boxes and counts that grow bin by bin, along three axes at once.
struct Sweep {
    Box boxes[3];
    Float4 counts;

    HWY_INLINE Sweep() : boxes{nothing(), nothing(), nothing()}, counts(Float4(0.0F)) {}
    HWY_INLINE void include(const Bin& bin) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            boxes[axis] = join(boxes[axis], load_box(bin.boxes[axis]));
        }
        counts = counts + load_int32(bin.counts);
    }
    /// Not a number where there is no box yet.
    HWY_INLINE Float4 cost() const {
        const Float4 last = extent(boxes[2]);
        const Float4 areas = half_areas(transpose(extent(boxes[0]), extent(boxes[1]), last, last));
        return areas * counts;
    }
};

/// The number of primitives left of the cut, and the boxes of both sides.
HWY_INLINE void complete(const Bins& bins, const Binning& binning, Split& split) {
    const std::uint32_t axis = split.axis;
    std::int32_t count = 0;
    Box left = nothing(), right = nothing();
    for (std::uint32_t i = 0; i < split.first_right_bin; ++i) {
        left = join(left, load_box(bins.at[i].boxes[axis]));
        count += bins.at[i].counts[axis];
    }
    for (std::uint32_t i = split.first_right_bin; i < binning.bins; ++i) {
        right = join(right, load_box(bins.at[i].boxes[axis]));
    }
    split.left_count = static_cast<std::uint32_t>(count);
    store_box(left, split.box[0]);
    store_box(right, split.box[1]);
}

// Wald 2007, sections 3.1 to 3.3: bins over the centres, swept from both sides.
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
    alignas(16) float costs[4], places[4];
    best.store(costs);
    best_bin.store(places);
    Split split{};
    split.cost = kHighest;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        if (costs[axis] < split.cost) {
            split.cost = costs[axis];
            split.axis = axis;
            split.first_right_bin = static_cast<std::uint32_t>(places[axis]);
        }
    }
    if (split.first_right_bin != 0) {
        complete(bins, binning, split);
    }
    return split;
}

/// The bounds of centres on both sides.
struct Centres {
    Box left, right;
};

HWY_INLINE Centres part_stably(const PartitionTask& parting,
                               const Binning& binning,
                               const Split& split) {
    const std::size_t axis = split.axis;
    const float lower = binning.lower[axis];
    const float scale = binning.scale[axis];
    const float first_right = kRounder + static_cast<float>(split.first_right_bin);
    Centres centres = {nothing(), nothing()};
    const std::ptrdiff_t gap = parting.right - parting.left;
    std::ptrdiff_t left = 0;
    for (std::size_t i = 0; i < parting.count; ++i) {
        const PrimRef& ref = parting.refs[i];
        const Box box = load_box(ref);
        const float place = (doubled_centroid(ref, axis) - lower) * scale + kRounder;
        // Which side comes next is hard to predict, so no branch depends on it.
        const std::ptrdiff_t goes_left = place < first_right ? 1 : 0;
        const std::ptrdiff_t right = gap + static_cast<std::ptrdiff_t>(i) - left;
        store_box(box, parting.left[right ^ ((right ^ left) & -goes_left)]);
        left += goes_left;
        const Float8::Mask is_left = Float8(place) < Float8(first_right);
        const Box centre = centre_box(box);
        centres.left = join(centres.left, select(is_left, centre, nothing()));
        centres.right = join(centres.right, select(is_left, nothing(), centre));
    }
    return centres;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
