// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/internal/box_ref.h"
#include "earshot/bvh/tree.h"

#include <span>

namespace earshot::bvh {

// The steps of cutting boxes between bins that are compiled once per instruction set. They compute
// the same bits on all of them: maxima, sums and products lane by lane, nothing fused.

inline constexpr std::size_t kMostBins = 32;

/// From this depth on, ranges are halved by count: 2^31 primitives end kMaxDepth - 32 + 31 levels
/// down, whatever their boxes look like.
inline constexpr std::uint32_t kHalvingDepth = 32;

/// Bounds are brought into this range while cutting, where twice a centre and widths of twice a
/// centre are finite.
inline constexpr float kFarthest = 0x1p+125F;

/// The bounds of boxes, and of twice their centres.
struct Bounds {
    WideBox box;
    WideBox centres;
};

/// Boxes and numbers of the primitives whose centres lie in a bin, for every axis.
struct alignas(64) Bin {
    WideBox boxes[3];
    std::int32_t counts[8];  // three are used
};

struct Bins {
    Bin at[kMostBins];
};

/// How centres map to bins: (centre - lower) * scale, rounded to the nearest, so that the outermost
/// bins are half as wide as the others. Scale 0: all of them in bin 0.
struct alignas(16) Binning {
    float lower[4];
    float scale[4];
    std::uint32_t bins;
};

/// Where a range is cut in two. `left_count` 0: nowhere, because all centres lie in one bin.
struct Split {
    std::uint32_t axis;
    std::uint32_t first_right_bin;
    std::uint32_t left_count;
    float cost;  ///< of both sides as leaves, times their half areas
    WideBox box[2];
};

/// How ranges are cut and when they become leaves.
struct CutRule {
    std::uint32_t leaf_size = 4;
    float traversal_cost = 1.0F;
    bool at_middle = false;  ///< in the middle of the longest side, not where it is cheapest
};

/// A run of references and what is known of it. It stands in refs[side]; the same run of the other
/// array is free.
struct Subtree {
    WideBox* refs[2];
    std::uint32_t begin, end;
    std::uint32_t side;
    std::uint32_t depth;
    Bounds bounds;
};

/// Makes references to boxes, given as six floats each, whose indices count from `first`, and
/// returns their bounds.
void refer(
    const float* boxes, std::uint32_t first, std::size_t count, WideBox* refs, Bounds& bounds);

/// How to bin `count` references with these bounds.
Binning binning_of(const CutRule& rule, const Bounds& bounds, std::size_t count);

/// Counts and joins references into bins.
void fill_bins(const WideBox* refs, std::size_t count, const Binning& binning, Bins& bins);

/// Adds what is in `more` to `bins`.
void join_bins(const Bins& more, const Binning& binning, Bins& bins);

/// The cheapest cut between two bins.
Split find_split(const Bins& bins, const Binning& binning);

/// Copies references to the left or to the right side of a split, in their order, and gives the
/// bounds of the centres on either side.
struct Parting {
    const WideBox* refs;
    std::size_t count;
    WideBox* left;
    WideBox* right;
};
void part(const Parting& parting, const Binning& binning, const Split& split, WideBox* centres);

/// Builds the whole tree over a range: nodes[0] is its root, at most 2 * count - 1 are written, and
/// their number is returned. Inner nodes count from nodes[0], leaves from refs[...][0]; the indices
/// of primitives go to primitives[begin ... end - 1].
std::uint32_t build_subtree(const Subtree& subtree,
                            const CutRule& rule,
                            RawNode* nodes,
                            std::uint32_t* primitives);

/// The tree over boxes by such cuts.
Tree build_by_bins(std::span<const geometry::Aabb> boxes, const CutRule& rule, Executor& executor);

/// Moves the half of the references whose centres along the longest axis of `box` are lower to the
/// front, ties by index, and returns its size. For all instruction sets alike.
std::size_t halve(WideBox* refs, std::size_t count, const WideBox& box);

}  // namespace earshot::bvh
