// SPDX-License-Identifier: MIT
#include "earshot/visibility/coherent_line_of_sight.h"

#include "earshot/bvh/traverse_wide.h"
#include "earshot/visibility/internal/batch_query.h"
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
constexpr std::size_t kBatchGrain = 4096;

/// Of a matrix, from which on points of one side are held in groups.
constexpr std::size_t kMinGroupedPoints = 256;

/// Fewer viewers share threads for their rays.
constexpr std::size_t kMinParallelViewers = 4;

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

std::size_t count_of(std::span<const bvh::TriangleRange> ranges) {
    std::size_t count = 0;
    for (const bvh::TriangleRange& range : ranges) {
        count += range.end - range.begin;
    }
    return count;
}

/// A box of the triangles in the ranges; all of space, where these are most of a large mesh: their
/// box would tell little then, and take long.
geometry::Aabb box_of(const MeshView& mesh, std::span<const bvh::TriangleRange> ranges) {
    constexpr std::size_t kMinLargeMesh = std::size_t{1} << 17U;
    geometry::Aabb box;
    if (mesh.triangles.size() >= kMinLargeMesh && 2 * count_of(ranges) > mesh.triangles.size()) {
        constexpr double kMaxCoordinate = 1e12;  // of line_of_sight.h
        box.include(Vec3(-kMaxCoordinate));
        box.include(Vec3(kMaxCoordinate));
        return box;
    }
    for (const bvh::TriangleRange& range : ranges) {
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const auto [a, b, c] = geometry::corners(mesh, i);
            box.include(geometry::triangle_box(a, b, c));
        }
    }
    return box;
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
    has_motion_ = !ranges.empty();
    moved_box_ = box_of(mesh, ranges);
    swept_box_ = moved_box_;
    if (groups_) {
        swept_box_.include(box_of({positions_, mesh.triangles}, ranges));
    }
    if (has_motion_) {
        // A refit of all is faster than that of many parts.
        2 * count_of(ranges) > mesh.triangles.size() ? tree_.update(mesh, executor)
                                                     : tree_.update(mesh, ranges, executor);
        positions_.assign(mesh.positions.begin(), mesh.positions.end());
    }
    if (collects_statistics_) {
        mark_slots();
    }
    ++call_;
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
void CoherentLineOfSight::answer_one_by_one(const MeshView& mesh,
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

/// Pairs that are answered together.
struct CoherentLineOfSight::Chunk {
    std::size_t begin = 0, end = 0;
    std::vector<std::uint32_t> rest{};  // whose last answer does not hold, after `begin`
    std::vector<Segment> segments{};    // of these
    Persistence persistence{};
};

// The tests that are cheap: those of what rests, and of the last blocker.
template <typename SegmentOf, typename HasMoved>
void CoherentLineOfSight::answer_chunk(const MeshView& mesh,
                                       const SegmentOf& segment_of,
                                       const HasMoved& has_moved,
                                       Chunk& chunk) {
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
        const TriangleId last = states_[i];
        const bool rests = !has_moved(i);
        if (last < kUnknown) {
            ++chunk.persistence.known;
            if (rests && moved_[last] == 0) {
                ++chunk.persistence.kept;
                continue;
            }
            if (tests_blockers_ || is_sample(i)) {
                ++chunk.persistence.tested;
                if (touches(segment_of(i), mesh, last)) {
                    ++chunk.persistence.kept;
                    ++chunk.persistence.kept_when_tested;
                    continue;
                }
            }
        } else if (last == kNoBlocker && rests &&
                   (!has_motion_ || !may_intersect_moved(segment_of(i)))) {
            // Between two resting points that were mutually visible only a moved triangle can be.
            continue;
        }
        chunk.rest.push_back(static_cast<std::uint32_t>(i - chunk.begin));
        chunk.segments.push_back(segment_of(i));
    }
}

void CoherentLineOfSight::query_rest(const MeshView& mesh, Chunk& chunk) {
    const bvh::MeshBvh bvh(tree_.tree(), mesh);
    std::vector<std::uint8_t> visible(chunk.rest.size());
    query_batch(bvh, chunk.segments, excluded_, std::span(visible), Executor::serial());
    std::vector<geometry::Ray> rays;
    std::vector<std::size_t> places;  // of the rays' pairs in the chunk's lists
    for (std::size_t k = 0; k < chunk.rest.size(); ++k) {
        const std::size_t i = chunk.begin + chunk.rest[k];
        visible_[i] = visible[k];
        states_[i] = visible[k] != 0 ? kNoBlocker : kUnknown;
        if (visible[k] == 0 && (searches_blockers_ || is_sample(i))) {
            const Segment& segment = chunk.segments[k];
            rays.push_back({segment.from, segment.to - segment.from, 1.0});
            places.push_back(k);
        }
    }
    const std::vector<std::optional<geometry::Hit>> hits = bvh.closest_hits(rays);
    for (std::size_t k = 0; k < hits.size(); ++k) {
        // A hit is not decided as exactly as a line of sight.
        if (hits[k] && !excluded_.contains(hits[k]->triangle) &&
            touches(chunk.segments[places[k]], mesh, hits[k]->triangle)) {
            states_[chunk.begin + chunk.rest[places[k]]] = hits[k]->triangle;
        }
    }
}

template <typename SegmentOf, typename HasMoved>
void CoherentLineOfSight::answer(const MeshView& mesh,
                                 const SegmentOf& segment_of,
                                 const HasMoved& has_moved,
                                 Executor& executor) {
    if (collects_statistics_) {
        answer_one_by_one(mesh, segment_of, has_moved, executor);
        return;
    }
    std::vector<Persistence> persistence(chunk_count(states_.size(), kBatchGrain));
    executor.for_each(states_.size(), kBatchGrain, [&](std::size_t begin, std::size_t end) {
        Chunk chunk{.begin = begin, .end = end};
        answer_chunk(mesh, segment_of, has_moved, chunk);
        query_rest(mesh, chunk);
        persistence[begin / kBatchGrain] = chunk.persistence;
    });
    Persistence sum;
    for (const Persistence& of_chunk : persistence) {
        sum.known += of_chunk.known;
        sum.tested += of_chunk.tested;
        sum.kept += of_chunk.kept;
        sum.kept_when_tested += of_chunk.kept_when_tested;
    }
    // A test of a triangle takes about half as long as a ray of a batch, a search four times.
    tests_blockers_ = 2 * sum.kept_when_tested >= sum.tested;
    searches_blockers_ = sum.known > 0 && 5 * sum.kept >= 4 * sum.known;
}

void CoherentLineOfSight::answer_in_groups(const MeshView& mesh,
                                           const PointSets& points,
                                           Executor& executor) {
    if (!groups_) {
        groups_.emplace(mesh, excluded_);
    }
    const bool is_transposed = points.from.size() > points.to.size();
    const std::span<const Vec3> viewers = is_transposed ? points.to : points.from;
    const std::span<const Vec3> members = is_transposed ? points.from : points.to;
    GroupOcclusion::Motion motion;
    if (has_motion_) {
        motion = {.triangles = moved_, .box = swept_box_};
    }
    const bvh::MeshBvh bvh(tree_.tree(), mesh);
    groups_->begin_frame(bvh, motion, viewers, members, executor);
    row_.resize(is_transposed ? viewers.size() * members.size() : 0);
    const auto answer_viewer = [&](std::size_t viewer, Executor& for_rays) {
        std::vector<std::uint8_t>& rows = is_transposed ? row_ : visible_;
        groups_->visible(
            viewer, std::span(rows).subspan(viewer * members.size(), members.size()), for_rays);
    };
    if (viewers.size() < kMinParallelViewers) {
        for (std::size_t viewer = 0; viewer < viewers.size(); ++viewer) {
            answer_viewer(viewer, executor);
        }
    } else {
        executor.for_each(viewers.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t viewer = begin; viewer < end; ++viewer) {
                answer_viewer(viewer, Executor::serial());
            }
        });
    }
    for (std::size_t i = 0; i < row_.size(); ++i) {
        visible_[i % members.size() * viewers.size() + i / members.size()] = row_[i];
    }
}

const std::vector<std::uint8_t>& CoherentLineOfSight::visible(const MeshView& mesh,
                                                              std::span<const Segment> segments,
                                                              Executor& executor) {
    update(mesh, executor);
    groups_.reset();
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
    const bool is_grouped = !collects_statistics_ &&
                            std::max(points.from.size(), columns) >= kMinGroupedPoints &&
                            !mesh.triangles.empty();
    if (is_grouped) {
        // What is known of single pairs is not followed meanwhile.
        states_.clear();
        visible_.resize(points.from.size() * columns);
        answer_in_groups(mesh, points, executor);
        from_.assign(points.from.begin(), points.from.end());
        to_.assign(points.to.begin(), points.to.end());
        segments_.clear();
        return visible_;
    }
    groups_.reset();
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
