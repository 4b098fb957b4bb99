// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/prim_refs.h"

#include <algorithm>

namespace earshot::bvh {

namespace {

/// Ranges up to this size are built by one task.
constexpr std::uint32_t kTaskSize = 16384;

/// Larger ranges are binned and partitioned in chunks of this size.
constexpr std::uint32_t kChunkSize = 4096;

/// Some references of a range.
struct Chunk {
    std::uint32_t node = 0;  // of the top
    std::uint32_t begin = 0, end = 0;
};

/// The split of a range of the present level.
struct RangeSplit {
    Binning binning{};
    Split split{};
    std::uint32_t first_chunk = 0, last_chunk = 0;
};

/// The upper levels of the tree, split level by level until ranges are small enough for a task
/// each. All ranges of a level are binned and partitioned in parallel, in chunks.
class UpperLevels {
public:
    UpperLevels(const BuildRange& all, const SplitRule& rule, Executor& executor)
        : rule_(rule), executor_(executor), ranges_{all} {
        std::uint32_t begin = 0;
        while (begin < ranges_.size()) {
            const auto end = static_cast<std::uint32_t>(ranges_.size());
            nodes_.resize(end);
            split_level(begin, end);
            begin = end;
        }
    }

    std::span<const TopNode> nodes() const { return nodes_; }
    std::span<const BuildRange> tasks() const { return tasks_; }

private:
    void split_level(std::uint32_t begin, std::uint32_t end) {
        chunks_.clear();
        splits_.assign(end - begin, {});
        for (std::uint32_t i = begin; i < end; ++i) {
            const BuildRange& range = ranges_[i];
            if (range.end - range.begin <= kTaskSize) {
                nodes_[i].task = static_cast<std::uint32_t>(tasks_.size());
                tasks_.push_back(range);
                continue;
            }
            RangeSplit& range_split = splits_[i - begin];
            range_split.first_chunk = static_cast<std::uint32_t>(chunks_.size());
            for (std::uint32_t from = range.begin; from < range.end; from += kChunkSize) {
                chunks_.push_back({i, from, std::min(from + kChunkSize, range.end)});
            }
            range_split.last_chunk = static_cast<std::uint32_t>(chunks_.size());
        }
        bins_.resize(std::max(bins_.size(), chunks_.size()));
        find_splits(begin);
        partition_all(begin);
        for (std::uint32_t i = begin; i < end; ++i) {
            if (splits_[i - begin].first_chunk != splits_[i - begin].last_chunk) {
                add_children(i, splits_[i - begin]);
            }
        }
    }

    std::uint32_t count_of(const Chunk& chunk) const { return chunk.end - chunk.begin; }

    const PrimRef* refs_of(const Chunk& chunk) const {
        const BuildRange& range = ranges_[chunk.node];
        return range.refs[range.buffer] + chunk.begin;
    }

    void find_splits(std::uint32_t begin) {
        for (std::size_t i = 0; i < splits_.size(); ++i) {
            const BuildRange& range = ranges_[begin + i];
            splits_[i].binning = choose_binning(rule_, range.bounds, range.end - range.begin);
        }
        executor_.for_each(chunks_.size(), 1, [&](std::size_t first, std::size_t) {
            const Chunk& chunk = chunks_[first];
            fill_bins(
                refs_of(chunk), count_of(chunk), splits_[chunk.node - begin].binning, bins_[first]);
        });
        executor_.for_each(splits_.size(), 1, [&](std::size_t first, std::size_t) {
            RangeSplit& range_split = splits_[first];
            if (range_split.first_chunk == range_split.last_chunk ||
                ranges_[begin + first].depth >= kMedianSplitDepth) {
                return;
            }
            Bins all = bins_[range_split.first_chunk];
            for (std::uint32_t i = range_split.first_chunk + 1; i < range_split.last_chunk; ++i) {
                merge_bins(bins_[i], range_split.binning, all);
            }
            range_split.split = find_split(all, range_split.binning);
        });
    }

    void partition_all(std::uint32_t begin) {
        // The counts of the bins tell where the left references of each chunk go.
        left_offsets_.assign(chunks_.size(), 0);
        for (std::size_t i = 0; i < splits_.size(); ++i) {
            const RangeSplit& range_split = splits_[i];
            std::uint32_t left = ranges_[begin + i].begin;
            for (std::uint32_t chunk = range_split.first_chunk; chunk < range_split.last_chunk;
                 ++chunk) {
                left_offsets_[chunk] = left;
                for (std::uint32_t bin = 0; bin < range_split.split.first_right_bin; ++bin) {
                    left += static_cast<std::uint32_t>(
                        bins_[chunk].at[bin].counts[range_split.split.axis]);
                }
            }
        }
        centroids_.resize(std::max(centroids_.size(), 2 * chunks_.size()));
        executor_.for_each(chunks_.size(), 1, [&](std::size_t first, std::size_t) {
            const Chunk& chunk = chunks_[first];
            const RangeSplit& range_split = splits_[chunk.node - begin];
            if (range_split.split.first_right_bin == 0) {
                return;
            }
            const BuildRange& range = ranges_[chunk.node];
            PrimRef* const target = range.refs[1 - range.buffer];
            const std::uint32_t middle = range.begin + range_split.split.left_count;
            // References before the chunk that did not go to the left went to the right.
            const std::uint32_t right = middle + (chunk.begin - left_offsets_[first]);
            partition(
                {refs_of(chunk), count_of(chunk), target + left_offsets_[first], target + right},
                range_split.binning,
                range_split.split,
                &centroids_[2 * first]);
        });
    }

    void add_children(std::uint32_t index, const RangeSplit& range_split) {
        BuildRange range = ranges_[index];
        nodes_[index] = {.box = to_aabb(range.bounds.box),
                         .left = static_cast<std::uint32_t>(ranges_.size())};
        BuildRange left = range, right = range;
        left.depth = right.depth = range.depth + 1;
        if (range_split.split.first_right_bin == 0) {
            PrimRef* const refs = range.refs[range.buffer];
            const std::size_t count =
                split_at_median(refs + range.begin, range.end - range.begin, range.bounds.box);
            left.end = right.begin = range.begin + static_cast<std::uint32_t>(count);
            left.bounds = bounds_of({refs + left.begin, left.end - left.begin});
            right.bounds = bounds_of({refs + right.begin, right.end - right.begin});
        } else {
            left.end = right.begin = range.begin + range_split.split.left_count;
            left.buffer = right.buffer = 1 - range.buffer;
            left.bounds = {range_split.split.box[0], empty_bounds().centroids};
            right.bounds = {range_split.split.box[1], empty_bounds().centroids};
            for (std::uint32_t i = range_split.first_chunk; i < range_split.last_chunk; ++i) {
                left.bounds.centroids = united(left.bounds.centroids, centroids_[2 * i]);
                right.bounds.centroids = united(right.bounds.centroids, centroids_[2 * i + 1]);
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
    std::vector<Chunk> chunks_;
    std::vector<RangeSplit> splits_;
    std::vector<Bins> bins_;                   // per chunk
    std::vector<std::uint32_t> left_offsets_;  // per chunk
    std::vector<BuildBox> centroids_;          // two per chunk
};

}  // namespace

Tree build_binned(std::span<const geometry::Aabb> boxes,
                  const SplitRule& rule,
                  Executor& executor) {
    PrimRefs refs(boxes, executor);
    const UpperLevels top(refs.root_range(), rule, executor);
    return refs.build_tree(top.nodes(), top.tasks(), rule, executor);
}

}  // namespace earshot::bvh
