// SPDX-License-Identifier: MIT
#include "earshot/base/large_pages.h"
#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/internal/builders.h"

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

/// A range too large for one task, or one that is left to a task.
struct TopNode {
    Subtree range;
    std::uint32_t left = 0;  // index of the left child; 0: a task
    std::uint32_t task = 0;
};

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
    Top(const Subtree& all, Executor& executor) : executor_(executor) {
        nodes_.push_back({.range = all});
        std::uint32_t begin = 0;
        while (begin < nodes_.size()) {
            const auto end = static_cast<std::uint32_t>(nodes_.size());
            cut_level(begin, end);
            begin = end;
        }
    }

    const std::vector<TopNode>& nodes() const { return nodes_; }
    const std::vector<std::uint32_t>& tasks() const { return tasks_; }

private:
    void cut_level(std::uint32_t begin, std::uint32_t end) {
        pieces_.clear();
        cuts_.assign(end - begin, {});
        for (std::uint32_t i = begin; i < end; ++i) {
            const Subtree& range = nodes_[i].range;
            if (range.end - range.begin <= kTaskSize) {
                nodes_[i].task = static_cast<std::uint32_t>(tasks_.size());
                tasks_.push_back(i);
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
        const Subtree& range = nodes_[piece.node].range;
        return range.refs[range.side] + piece.begin;
    }

    void find_splits(std::uint32_t begin) {
        for (std::size_t i = 0; i < cuts_.size(); ++i) {
            const Subtree& range = nodes_[begin + i].range;
            cuts_[i].binning = binning_of(range.bounds.centres, range.end - range.begin);
        }
        executor_.for_each(pieces_.size(), 1, [&](std::size_t first, std::size_t) {
            const Piece& piece = pieces_[first];
            fill_bins(
                refs_of(piece), count_of(piece), cuts_[piece.node - begin].binning, bins_[first]);
        });
        executor_.for_each(cuts_.size(), 1, [&](std::size_t first, std::size_t) {
            Cut& cut = cuts_[first];
            if (cut.first_piece == cut.last_piece ||
                nodes_[begin + first].range.depth >= kHalvingDepth) {
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
            std::uint32_t left = nodes_[begin + i].range.begin;
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
            const Subtree& range = nodes_[piece.node].range;
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
        Subtree range = nodes_[index].range;
        nodes_[index].left = static_cast<std::uint32_t>(nodes_.size());
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
        nodes_.push_back({.range = left});
        nodes_.push_back({.range = right});
    }

    static void bound(Subtree& range) {
        range.bounds = {no_box(), no_box()};
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const WideBox& ref = range.refs[range.side][i];
            range.bounds = joined(range.bounds, {ref, centre_box(ref)});
        }
    }

    Executor& executor_;
    std::vector<TopNode> nodes_;
    std::vector<std::uint32_t> tasks_;  // indices of nodes
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

Node finished(const RawNode& raw, std::uint32_t shift) {
    Node node;
    node.first = raw.first + (raw.count == 0 ? shift : 0);
    node.count = raw.count;
    std::copy_n(raw.lower, 3, node.box.lower.begin());
    std::copy_n(raw.upper, 3, node.box.upper.begin());
    return node;
}

/// Joins the top and the tasks' trees in depth-first order.
class Joiner {
public:
    Joiner(const Top& top, const std::vector<std::uint32_t>& counts)
        : top_(top), counts_(counts), shifts_(counts.size()) {
        std::size_t all = 1;
        for (const TopNode& node : top.nodes()) {
            all += node.left != 0 ? 2 : counts[node.task] - 1;
        }
        nodes_.reserve(all);
        ask_for_large_pages(nodes_.data(), all * sizeof(Node));
        nodes_.resize(all);
        place(0, 0);
    }

    std::vector<Node> join(Executor& executor) {
        executor.for_each(counts_.size(), 1, [&](std::size_t task, std::size_t) {
            for (std::uint32_t i = 1; i < counts_[task]; ++i) {
                nodes_[shifts_[task] + i] = finished(raw_node(task, i), shifts_[task]);
            }
        });
        return std::move(nodes_);
    }

private:
    RawNode raw_node(std::size_t task, std::uint32_t index) const {
        return stored(top_.nodes()[top_.tasks()[task]].range, index);
    }

    void place(std::uint32_t source, std::uint32_t target) {
        const TopNode& node = top_.nodes()[source];
        if (node.left == 0) {
            // A task's nodes follow its root, which goes to the slot beside its sibling.
            const std::uint32_t shift = next_ - 1;
            nodes_[target] = finished(raw_node(node.task, 0), shift);
            shifts_[node.task] = shift;
            next_ += counts_[node.task] - 1;
            return;
        }
        const std::uint32_t children = next_;
        next_ += 2;
        Node& inner = nodes_[target];
        inner.first = children;
        for (std::size_t k = 0; k < 3; ++k) {
            inner.box.lower[k] = 0.0F - node.range.bounds.box.low[k];
            inner.box.upper[k] = node.range.bounds.box.high[k];
        }
        place(node.left, children);
        place(node.left + 1, children + 1);
    }

    const Top& top_;
    const std::vector<std::uint32_t>& counts_;
    std::vector<std::uint32_t> shifts_;
    std::vector<Node> nodes_;
    std::uint32_t next_ = 1;
};

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

Tree build_binned_sah(std::span<const Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor) {
    const References references(boxes, executor);
    const Top top(references.all(), executor);
    const LeafRule rule = {static_cast<std::uint32_t>(options.leaf_size),
                           static_cast<float>(options.traversal_cost)};
    std::vector<std::uint32_t> primitives(boxes.size());
    std::vector<std::uint32_t> counts(top.tasks().size());
    executor.for_each(counts.size(), 1, [&](std::size_t task, std::size_t) {
        const Subtree& range = top.nodes()[top.tasks()[task]].range;
        const UntouchedArray<RawNode> nodes(2 * (range.end - range.begin));
        counts[task] = build_subtree(range, rule, nodes.data(), primitives.data());
        store(range, nodes.data(), counts[task]);
    });
    Tree tree = Tree::from_nodes(Joiner(top, counts).join(executor), std::move(primitives));
    if (references.are_clamped()) {
        tree.refit(boxes, executor);
    }
    return tree;
}

}  // namespace earshot::bvh
