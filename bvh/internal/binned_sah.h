// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/internal/build_box.h"
#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::bvh {

// The steps of a binned SAH build (Wald 2007) that are compiled once per instruction set. They
// compute the same bits on all of them: maxima, sums and products lane by lane, nothing fused.

inline constexpr std::size_t kMaxBins = 32;

/// From this depth on, ranges are split at the median: 2^31 primitives end kMaxDepth - 32 + 31
/// levels down, whatever their boxes look like.
inline constexpr std::uint32_t kMedianSplitDepth = 32;

/// Bounds are clamped to this magnitude during a build, where twice a centroid and widths of twice
/// a centroid are finite.
inline constexpr float kMaxCoordinate = 0x1p+125F;

/// The bounds of primitives, and of twice their centroids.
struct Bounds {
    BuildBox box;
    BuildBox centroids;
};

/// For every axis, the bounds and the number of the primitives whose centroids lie in a bin.
struct alignas(64) Bin {
    BuildBox boxes[3];
    std::int32_t counts[8];  // three are used
};

struct Bins {
    Bin at[kMaxBins];
};

/// The map from centroids to bins: (doubled centroid - lower) * scale, rounded to the nearest, so
/// that the outermost bins are half as wide as the others. Scale 0: all of them in bin 0.
struct alignas(16) Binning {
    float lower[4];
    float scale[4];
    std::uint32_t bins;
};

/// A split of a range between two bins. `left_count` 0: there is none, because all centroids lie in
/// one bin.
struct Split {
    std::uint32_t axis;
    std::uint32_t first_right_bin;
    std::uint32_t left_count;
    float cost;  ///< the sum over both sides of primitive count times half area
    BuildBox box[2];
};

/// How ranges are split and when they become leaves.
struct SplitRule {
    std::uint32_t max_leaf_size = 4;
    float traversal_cost = 1.0F;
    bool spatial_median =
        false;  ///< split the middle of the longest side instead of minimising the SAH
};

/// A range of references with its bounds. The references are in refs[buffer]; the same range of the
/// other array is free.
struct BuildRange {
    PrimRef* refs[2];
    std::uint32_t begin, end;
    std::uint32_t buffer;
    std::uint32_t depth;
    Bounds bounds;
};

/// Makes references to boxes, given as six floats each, whose indices count from `first`, and
/// returns their bounds.
void make_prim_refs(
    const float* boxes, std::uint32_t first, std::size_t count, PrimRef* refs, Bounds& bounds);

/// The binning of `count` references with these bounds.
Binning choose_binning(const SplitRule& rule, const Bounds& bounds, std::size_t count);

/// Adds references to their bins.
void fill_bins(const PrimRef* refs, std::size_t count, const Binning& binning, Bins& bins);

/// Adds the bins of another chunk to `bins`.
void merge_bins(const Bins& other, const Binning& binning, Bins& bins);

/// The cheapest split between two bins.
Split find_split(const Bins& bins, const Binning& binning);

/// The references of a chunk, and the arrays that those of the left and of the right side are
/// copied to.
struct PartitionTask {
    const PrimRef* refs;
    std::size_t count;
    PrimRef* left;
    PrimRef* right;
};

/// Copies references to the left or to the right side of a split, in their order, and sets
/// centroids[0] and centroids[1] to the bounds of the centroids on either side.
void partition(const PartitionTask& task,
               const Binning& binning,
               const Split& split,
               BuildBox* centroids);

/// Builds the whole tree over a range: nodes[0] is its root, at most 2 * count - 1 are written, and
/// their number is returned. Inner nodes count from nodes[0], leaves from refs[...][0]; the indices
/// of primitives go to primitives[begin ... end - 1].
std::uint32_t build_subtree(const BuildRange& range,
                            const SplitRule& rule,
                            RawNode* nodes,
                            std::uint32_t* primitives);

/// The tree over boxes that is built by binned splits.
Tree build_binned(std::span<const geometry::Aabb> boxes, const SplitRule& rule, Executor& executor);

/// Moves the half of the references whose centroids along the longest axis of `box` are lower to
/// the front, ties by index, and returns its size. The same code for all instruction sets.
std::size_t split_at_median(PrimRef* refs, std::size_t count, const BuildBox& box);

}  // namespace earshot::bvh
