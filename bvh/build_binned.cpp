// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/prim_refs.h"

#include <algorithm>

namespace earshot::bvh {

namespace {

/// Ranges up to this size are built by one task.
constexpr std::uint32_t kTaskSize = 16384;

/// Larger ranges are binned and parted in pieces of this size.
constexpr std::uint32_t kPieceSize = 4096;

/// Some references of a range.
struct Piece {
    std::uint32_t node = 0;  // of the top
    std::uint32_t begin = 0, end = 0;
};

/// A range of the present level.
struct Cut {
    Binning binning{};
    Split split{};
    std::uint32_t first_piece = 0, last_piece = 0;
};

/// The top of the tree, cut level by level until ranges are small enough for a task each. All
/// ranges of a level are binned and parted together, in pieces.
class Top {
public:
    Top(const BuildRange& all, const SplitRule& rule, Executor& executor)
        : rule_(rule), executor_(executor), ranges_{all} {
        std::uint32_t begin = 0;
        while (begin < ranges_.size()) {
            const auto end = static_cast<std::uint32_t>(ranges_.size());
            nodes_.resize(end);
            cut_level(begin, end);
            begin = end;
        }
    }

    std::span<const TopNode> nodes() const { return nodes_; }
    std::span<const BuildRange> tasks() const { return tasks_; }

private:
    void cut_level(std::uint32_t begin, std::uint32_t end) {
        pieces_.clear();
        cuts_.assign(end - begin, {});
        for (std::uint32_t i = begin; i < end; ++i) {
            const BuildRange& range = ranges_[i];
            if (range.end - range.begin <= kTaskSize) {
                nodes_[i].task = static_cast<std::uint32_t>(tasks_.size());
                tasks_.push_back(range);
                continue;
            }
            Cut& cut = cuts_[i - begin];
            cut.first_piece = static_cast<std::uint32_t>(pieces_.size());
            for (std::uint32_t from = range.begin; from < range.end; from += kPieceSize) {
                pieces_.push_back({i, from, std::min(from + kPieceSize, range.end)});
            }
            cut.last_piece = static_cast<std::uint32_t>(pieces_.size());
        }
        bins_.resize(std::max(bins_.size(), pieces_.size()));
        find_splits(begin);
        part_all(begin);
        for (std::uint32_t i = begin; i < end; ++i) {
            if (cuts_[i - begin].first_piece != cuts_[i - begin].last_piece) {
                add_children(i, cuts_[i - begin]);
            }
        }
    }

    std::uint32_t count_of(const Piece& piece) const { return piece.end - piece.begin; }

    const PrimRef* refs_of(const Piece& piece) const {
        const BuildRange& range = ranges_[piece.node];
        return range.refs[range.side] + piece.begin;
    }

    void find_splits(std::uint32_t begin) {
        for (std::size_t i = 0; i < cuts_.size(); ++i) {
            const BuildRange& range = ranges_[begin + i];
            cuts_[i].binning = choose_binning(rule_, range.bounds, range.end - range.begin);
        }
        executor_.for_each(pieces_.size(), 1, [&](std::size_t first, std::size_t) {
            const Piece& piece = pieces_[first];
            fill_bins(
                refs_of(piece), count_of(piece), cuts_[piece.node - begin].binning, bins_[first]);
        });
        executor_.for_each(cuts_.size(), 1, [&](std::size_t first, std::size_t) {
            Cut& cut = cuts_[first];
            if (cut.first_piece == cut.last_piece ||
                ranges_[begin + first].depth >= kMedianSplitDepth) {
                return;
            }
            Bins all = bins_[cut.first_piece];
            for (std::uint32_t i = cut.first_piece + 1; i < cut.last_piece; ++i) {
                merge_bins(bins_[i], cut.binning, all);
            }
            cut.split = find_split(all, cut.binning);
        });
    }

    void part_all(std::uint32_t begin) {
        // Where the left part of each piece goes follows from the counts of its bins.
        lefts_.assign(pieces_.size(), 0);
        for (std::size_t i = 0; i < cuts_.size(); ++i) {
            const Cut& cut = cuts_[i];
            std::uint32_t left = ranges_[begin + i].begin;
            for (std::uint32_t piece = cut.first_piece; piece < cut.last_piece; ++piece) {
                lefts_[piece] = left;
                for (std::uint32_t bin = 0; bin < cut.split.first_right_bin; ++bin) {
                    left += static_cast<std::uint32_t>(bins_[piece].at[bin].counts[cut.split.axis]);
                }
            }
        }
        centres_.resize(std::max(centres_.size(), 2 * pieces_.size()));
        executor_.for_each(pieces_.size(), 1, [&](std::size_t first, std::size_t) {
            const Piece& piece = pieces_[first];
            const Cut& cut = cuts_[piece.node - begin];
            if (cut.split.first_right_bin == 0) {
                return;
            }
            const BuildRange& range = ranges_[piece.node];
            PrimRef* const target = range.refs[1 - range.side];
            const std::uint32_t middle = range.begin + cut.split.left_count;
            // As many as stand before the piece and did not go to the left went to the right.
            const std::uint32_t right = middle + (piece.begin - lefts_[first]);
            partition({refs_of(piece), count_of(piece), target + lefts_[first], target + right},
                      cut.binning,
                      cut.split,
                      &centres_[2 * first]);
        });
    }

    void add_children(std::uint32_t index, const Cut& cut) {
        BuildRange range = ranges_[index];
        nodes_[index] = {.box = to_aabb(range.bounds.box),
                         .left = static_cast<std::uint32_t>(ranges_.size())};
        BuildRange left = range, right = range;
        left.depth = right.depth = range.depth + 1;
        if (cut.split.first_right_bin == 0) {
            PrimRef* const refs = range.refs[range.side];
            const std::size_t count =
                split_at_median(refs + range.begin, range.end - range.begin, range.bounds.box);
            left.end = right.begin = range.begin + static_cast<std::uint32_t>(count);
            left.bounds = bounds_of({refs + left.begin, left.end - left.begin});
            right.bounds = bounds_of({refs + right.begin, right.end - right.begin});
        } else {
            left.end = right.begin = range.begin + cut.split.left_count;
            left.side = right.side = 1 - range.side;
            left.bounds = {cut.split.box[0], empty_bounds().centroids};
            right.bounds = {cut.split.box[1], empty_bounds().centroids};
            for (std::uint32_t i = cut.first_piece; i < cut.last_piece; ++i) {
                left.bounds.centroids = united(left.bounds.centroids, centres_[2 * i]);
                right.bounds.centroids = united(right.bounds.centroids, centres_[2 * i + 1]);
            }
        }
        ranges_.push_back(left);
        ranges_.push_back(right);
    }

    SplitRule rule_;
    Executor& executor_;
    std::vector<BuildRange> ranges_;
    std::vector<TopNode> nodes_;  // per range
    std::vector<BuildRange> tasks_;
    std::vector<Piece> pieces_;
    std::vector<Cut> cuts_;
    std::vector<Bins> bins_;            // per piece
    std::vector<std::uint32_t> lefts_;  // per piece
    std::vector<BuildBox> centres_;     // two per piece
};

}  // namespace

Tree build_binned(std::span<const geometry::Aabb> boxes,
                  const SplitRule& rule,
                  Executor& executor) {
    PrimRefs refs(boxes, executor);
    const Top top(refs.root_range(), rule, executor);
    return refs.build_tree(top.nodes(), top.tasks(), rule, executor);
}

}  // namespace earshot::bvh
