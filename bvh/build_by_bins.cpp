// SPDX-License-Identifier: MIT
#include "earshot/base/large_pages.h"
#include "earshot/bvh/internal/assemble.h"
#include "earshot/bvh/internal/bin_cuts.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace earshot::bvh {

using geometry::Aabb;

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

WideBox joined(const WideBox& a, const WideBox& b) {
    WideBox result;
    for (std::size_t k = 0; k < 4; ++k) {
        result.low[k] = std::max(a.low[k], b.low[k]);
        result.high[k] = std::max(a.high[k], b.high[k]);
    }
    return result;
}

Bounds joined(const Bounds& a, const Bounds& b) {
    return {joined(a.box, b.box), joined(a.centres, b.centres)};
}

WideBox no_box() {
    constexpr float kLowest = -std::numeric_limits<float>::max();
    return {{kLowest, kLowest, kLowest, kLowest}, {kLowest, kLowest, kLowest, kLowest}};
}

/// The box of a single point: twice the centre.
WideBox centre_box(const WideBox& box) {
    WideBox centre;
    for (std::size_t k = 0; k < 4; ++k) {
        centre.low[k] = box.low[k] - box.high[k];
        centre.high[k] = box.high[k] - box.low[k];
    }
    return centre;
}

Aabb finished(const WideBox& box) {
    Aabb result;
    for (std::size_t k = 0; k < 3; ++k) {
        result.lower[k] = 0.0F - box.low[k];
        result.upper[k] = box.high[k];
    }
    return result;
}

/// The references, and a second array to part them into.
class References {
public:
    References(std::span<const Aabb> boxes, Executor& executor)
        : count_(static_cast<std::uint32_t>(boxes.size())),
          arrays_{UntouchedArray<WideBox>(count_), UntouchedArray<WideBox>(count_)} {
        std::vector<Bounds> chunks(chunk_count(count_, kTaskSize));
        executor.for_each(count_, kTaskSize, [&](std::size_t begin, std::size_t end) {
            refer(boxes[begin].lower.data(),
                  static_cast<std::uint32_t>(begin),
                  end - begin,
                  arrays_[0].data() + begin,
                  chunks[begin / kTaskSize]);
        });
        for (const Bounds& chunk : chunks) {
            bounds_ = joined(bounds_, chunk);
        }
    }

    Subtree all() const {
        return {.refs = {arrays_[0].data(), arrays_[1].data()},
                .begin = 0,
                .end = count_,
                .side = 0,
                .depth = 0,
                .bounds = bounds_};
    }

    /// Whether some bounds are not what they were.
    bool are_clamped() const {
        const WideBox& box = bounds_.box;
        return std::max(*std::max_element(box.low, box.low + 3),
                        *std::max_element(box.high, box.high + 3)) >= kFarthest;
    }

private:
    std::uint32_t count_;
    UntouchedArray<WideBox> arrays_[2];
    Bounds bounds_ = {no_box(), no_box()};
};

/// The top of the tree, cut level by level until ranges are small enough for a task each. All
/// ranges of a level are binned and parted together, in pieces.
class Top {
public:
    Top(const Subtree& all, const CutRule& rule, Executor& executor)
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
    std::span<const Subtree> tasks() const { return tasks_; }

private:
    void cut_level(std::uint32_t begin, std::uint32_t end) {
        pieces_.clear();
        cuts_.assign(end - begin, {});
        for (std::uint32_t i = begin; i < end; ++i) {
            const Subtree& range = ranges_[i];
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

    const WideBox* refs_of(const Piece& piece) const {
        const Subtree& range = ranges_[piece.node];
        return range.refs[range.side] + piece.begin;
    }

    void find_splits(std::uint32_t begin) {
        for (std::size_t i = 0; i < cuts_.size(); ++i) {
            const Subtree& range = ranges_[begin + i];
            cuts_[i].binning = binning_of(rule_, range.bounds, range.end - range.begin);
        }
        executor_.for_each(pieces_.size(), 1, [&](std::size_t first, std::size_t) {
            const Piece& piece = pieces_[first];
            fill_bins(
                refs_of(piece), count_of(piece), cuts_[piece.node - begin].binning, bins_[first]);
        });
        executor_.for_each(cuts_.size(), 1, [&](std::size_t first, std::size_t) {
            Cut& cut = cuts_[first];
            if (cut.first_piece == cut.last_piece ||
                ranges_[begin + first].depth >= kHalvingDepth) {
                return;
            }
            Bins all = bins_[cut.first_piece];
            for (std::uint32_t i = cut.first_piece + 1; i < cut.last_piece; ++i) {
                join_bins(bins_[i], cut.binning, all);
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
            const Subtree& range = ranges_[piece.node];
            WideBox* const target = range.refs[1 - range.side];
            const std::uint32_t middle = range.begin + cut.split.left_count;
            // As many as stand before the piece and did not go to the left went to the right.
            const std::uint32_t right = middle + (piece.begin - lefts_[first]);
            part({refs_of(piece), count_of(piece), target + lefts_[first], target + right},
                 cut.binning,
                 cut.split,
                 &centres_[2 * first]);
        });
    }

    void add_children(std::uint32_t index, const Cut& cut) {
        Subtree range = ranges_[index];
        nodes_[index] = {.box = finished(range.bounds.box),
                         .left = static_cast<std::uint32_t>(ranges_.size())};
        Subtree left = range, right = range;
        left.depth = right.depth = range.depth + 1;
        if (cut.split.first_right_bin == 0) {
            WideBox* const refs = range.refs[range.side];
            const std::size_t count =
                halve(refs + range.begin, range.end - range.begin, range.bounds.box);
            left.end = right.begin = range.begin + static_cast<std::uint32_t>(count);
            bound(left);
            bound(right);
        } else {
            left.end = right.begin = range.begin + cut.split.left_count;
            left.side = right.side = 1 - range.side;
            left.bounds = {cut.split.box[0], no_box()};
            right.bounds = {cut.split.box[1], no_box()};
            for (std::uint32_t i = cut.first_piece; i < cut.last_piece; ++i) {
                left.bounds.centres = joined(left.bounds.centres, centres_[2 * i]);
                right.bounds.centres = joined(right.bounds.centres, centres_[2 * i + 1]);
            }
        }
        ranges_.push_back(left);
        ranges_.push_back(right);
    }

    static void bound(Subtree& range) {
        range.bounds = {no_box(), no_box()};
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const WideBox& ref = range.refs[range.side][i];
            range.bounds = joined(range.bounds, {ref, centre_box(ref)});
        }
    }

    CutRule rule_;
    Executor& executor_;
    std::vector<Subtree> ranges_;
    std::vector<TopNode> nodes_;  // per range
    std::vector<Subtree> tasks_;
    std::vector<Piece> pieces_;
    std::vector<Cut> cuts_;
    std::vector<Bins> bins_;            // per piece
    std::vector<std::uint32_t> lefts_;  // per piece
    std::vector<WideBox> centres_;      // two per piece
};

// When a subtree is built, its references are not needed any more, and there is room for all of its
// nodes where they stood: first in one array, then in the other.

void store(const Subtree& range, const RawNode* nodes, std::uint32_t count) {
    static_assert(sizeof(RawNode) == sizeof(WideBox));
    const std::uint32_t size = range.end - range.begin;
    const std::uint32_t first = std::min(count, size);
    std::memcpy(static_cast<void*>(range.refs[0] + range.begin), nodes, first * sizeof(RawNode));
    std::memcpy(static_cast<void*>(range.refs[1] + range.begin),
                nodes + first,
                (count - first) * sizeof(RawNode));
}

RawNode stored(const Subtree& range, std::uint32_t index) {
    const std::uint32_t size = range.end - range.begin;
    const WideBox* const place = index < size ? range.refs[0] + range.begin + index
                                              : range.refs[1] + range.begin + (index - size);
    RawNode node;
    std::memcpy(&node, place, sizeof(node));
    return node;
}

Node finished(const RawNode& raw) {
    Node node;
    node.first = raw.first;
    node.count = raw.count;
    std::copy_n(raw.lower, 3, node.box.lower.begin());
    std::copy_n(raw.upper, 3, node.box.upper.begin());
    return node;
}

}  // namespace

std::size_t halve(WideBox* refs, std::size_t count, const WideBox& box) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (box.low[k] + box.high[k] > box.low[axis] + box.high[axis]) {
            axis = k;
        }
    }
    const std::size_t middle = count / 2;
    std::nth_element(refs, refs + middle, refs + count, [&](const WideBox& a, const WideBox& b) {
        const float ca = centre_of(a, axis);
        const float cb = centre_of(b, axis);
        return ca != cb ? ca < cb : index_of(a) < index_of(b);
    });
    return middle;
}

Tree build_by_bins(std::span<const Aabb> boxes, const CutRule& rule, Executor& executor) {
    const References references(boxes, executor);
    const Top top(references.all(), rule, executor);
    std::vector<std::uint32_t> primitives(boxes.size());
    std::vector<std::uint32_t> counts(top.tasks().size());
    executor.for_each(counts.size(), 1, [&](std::size_t task, std::size_t) {
        const Subtree& range = top.tasks()[task];
        const UntouchedArray<RawNode> nodes(2 * (range.end - range.begin));
        counts[task] = build_subtree(range, rule, nodes.data(), primitives.data());
        store(range, nodes.data(), counts[task]);
    });
    const auto node_of = [&](std::uint32_t task, std::uint32_t index) {
        return finished(stored(top.tasks()[task], index));
    };
    Tree tree = Tree::from_nodes(Assembly(top.nodes(), counts, node_of).nodes(executor),
                                 std::move(primitives));
    if (references.are_clamped()) {
        tree.refit(boxes, executor);
    }
    return tree;
}

}  // namespace earshot::bvh
