// SPDX-License-Identifier: MIT
#include "earshot/visibility/coherent_line_of_sight.h"

#include "earshot/bvh/traverse_wide.h"
#include "earshot/visibility/internal/mesh_touch.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace earshot::visibility {

using geometry::MeshView;
using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kGrain = 512;

/// The state of a pair without an earlier answer.
constexpr TriangleId kUnknown = kNoBlocker - 1;

bool is_same(const Segment& a, const Segment& b) noexcept {
    return a.from == b.from && a.to == b.to;
}

/// Flags of the points that are not where they were.
std::vector<std::uint8_t> moved_points(std::span<const Vec3> before, std::span<const Vec3> now) {
    std::vector<std::uint8_t> moved(now.size(), 1);
    for (std::size_t i = 0; i < std::min(before.size(), now.size()); ++i) {
        moved[i] = before[i] != now[i] ? 1 : 0;
    }
    return moved;
}

}  // namespace

CoherentLineOfSight::CoherentLineOfSight(const MeshView& mesh,
                                         ExclusionMask excluded,
                                         const bvh::UpdateOptions& options,
                                         Executor& executor)
    : excluded_(std::move(excluded)),
      tree_(mesh, options, executor),
      positions_(mesh.positions.begin(), mesh.positions.end()),
      moved_(mesh.triangles.size()) {}

void CoherentLineOfSight::update(const MeshView& mesh, Executor& executor) {
    moved_ = bvh::moved_flags(mesh, positions_, executor);
    const std::vector<bvh::TriangleRange> ranges = bvh::ranges_of(moved_);
    if (!ranges.empty()) {
        tree_.update(mesh, ranges, executor);
        positions_.assign(mesh.positions.begin(), mesh.positions.end());
    }
    moved_box_ = {};
    for (const bvh::TriangleRange& range : ranges) {
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const auto [a, b, c] = geometry::corners(mesh, i);
            moved_box_.include(geometry::triangle_box(a, b, c));
        }
    }
    mark_slots();
}

bool CoherentLineOfSight::may_intersect_moved(const Segment& segment) const noexcept {
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, tree_.tree().max_abs_coordinate());
    return !moved_box_.is_empty() && !slab_test.interval(moved_box_, 1.0).is_empty();
}

void CoherentLineOfSight::mark_slots() {
    const bvh::WideTree& tree = tree_.tree();
    moved_slots_.assign(tree.nodes().size(), 0);
    // Parents stand before their children.
    for (std::size_t index = moved_slots_.size(); index-- > 0;) {
        for (std::size_t slot = 0; slot < bvh::WideNode::kWidth; ++slot) {
            const std::uint32_t child = tree.nodes()[index].child[slot];
            bool has_moved = false;
            if (bvh::is_leaf(child)) {
                const auto triangles = tree.leaf_triangles(child);
                has_moved = std::any_of(triangles.begin(), triangles.end(), [&](TriangleId id) {
                    return moved_[id] != 0;
                });
            } else if (child != bvh::kNoChild) {
                has_moved = moved_slots_[child] != 0;
            }
            moved_slots_[index] |= static_cast<std::uint8_t>((has_moved ? 1U : 0U) << slot);
        }
    }
}

void CoherentLineOfSight::expect_pairs(std::size_t count) {
    if (states_.size() != count) {
        states_.assign(count, kUnknown);
        visible_.resize(count);
    }
}

TriangleId CoherentLineOfSight::state_of(const MeshView& mesh,
                                         const Segment& segment,
                                         TriangleId last,
                                         bool has_moved,
                                         LineOfSightStatistics& statistics) const noexcept {
    const auto blocks = [&](TriangleId id) {
        ++statistics.triangles;
        return touches(segment, mesh, id);
    };
    if (last < kUnknown && ((!has_moved && moved_[last] == 0) || blocks(last))) {
        ++statistics.kept;
        return last;
    }
    // Between two resting points that were mutually visible only a moved triangle can be now.
    const bool is_free_of_resting = last == kNoBlocker && !has_moved;
    if (is_free_of_resting && !may_intersect_moved(segment)) {
        ++statistics.kept;
        return last;
    }
    // The wide kernels are faster at telling that no triangle blocks, but not which one does.
    if (!collects_statistics_ && !tree_.view().occluded(segment)) {
        return kNoBlocker;
    }
    TriangleId blocker = kNoBlocker;
    statistics.nodes += bvh::traverse_front_to_back(
        tree_.tree(),
        segment,
        1.0,
        [&](std::uint32_t node, std::size_t slot) {
            return !is_free_of_resting || (moved_slots_[node] >> slot & 1U) != 0;
        },
        [&](TriangleId id) {
            if ((is_free_of_resting && moved_[id] == 0) || excluded_.contains(id) || !blocks(id)) {
                return true;
            }
            blocker = id;
            return false;
        });
    return blocker;
}

template <typename SegmentOf, typename HasMoved>
void CoherentLineOfSight::answer(const MeshView& mesh,
                                 const SegmentOf& segment_of,
                                 const HasMoved& has_moved,
                                 Executor& executor) {
    std::vector<LineOfSightStatistics> statistics(chunk_count(states_.size(), kGrain));
    executor.for_each(states_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        LineOfSightStatistics& of_chunk = statistics[begin / kGrain];
        for (std::size_t i = begin; i < end; ++i) {
            states_[i] = state_of(mesh, segment_of(i), states_[i], has_moved(i), of_chunk);
            visible_[i] = states_[i] == kNoBlocker ? 1 : 0;
        }
    });
    statistics_ = {};
    for (const LineOfSightStatistics& of_chunk : statistics) {
        statistics_.nodes += of_chunk.nodes;
        statistics_.triangles += of_chunk.triangles;
        statistics_.kept += of_chunk.kept;
    }
}

const std::vector<std::uint8_t>& CoherentLineOfSight::visible(const MeshView& mesh,
                                                              std::span<const Segment> segments,
                                                              Executor& executor) {
    update(mesh, executor);
    expect_pairs(segments.size());
    const auto has_moved = [&](std::size_t i) {
        return i >= segments_.size() || !is_same(segments_[i], segments[i]);
    };
    answer(
        mesh, [&](std::size_t i) { return segments[i]; }, has_moved, executor);
    segments_.assign(segments.begin(), segments.end());
    from_.clear();
    to_.clear();
    return visible_;
}

const std::vector<std::uint8_t>& CoherentLineOfSight::matrix(const MeshView& mesh,
                                                             const PointSets& points,
                                                             Executor& executor) {
    update(mesh, executor);
    const std::size_t columns = points.to.size();
    // As many pairs in a matrix of another shape are other pairs.
    if (from_.size() != points.from.size() || to_.size() != columns) {
        states_.clear();
    }
    expect_pairs(points.from.size() * columns);
    const std::vector<std::uint8_t> from_moved = moved_points(from_, points.from);
    const std::vector<std::uint8_t> to_moved = moved_points(to_, points.to);
    answer(
        mesh,
        [&](std::size_t i) {
            return Segment{points.from[i / columns], points.to[i % columns]};
        },
        [&](std::size_t i) { return (from_moved[i / columns] | to_moved[i % columns]) != 0; },
        executor);
    from_.assign(points.from.begin(), points.from.end());
    to_.assign(points.to.begin(), points.to.end());
    segments_.clear();
    return visible_;
}

}  // namespace earshot::visibility
