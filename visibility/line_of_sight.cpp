// SPDX-License-Identifier: MIT
#include "earshot/visibility/line_of_sight.h"

#include "earshot/bvh/better_hit.h"
#include "earshot/bvh/traverse_wide.h"
#include "earshot/visibility/internal/batch_query.h"
#include "earshot/visibility/internal/coherent_order.h"
#include "earshot/visibility/internal/mesh_touch.h"

#include <algorithm>
#include <cstddef>

namespace earshot::visibility {

using geometry::Segment;
using geometry::TriangleId;

namespace {

constexpr std::size_t kGrain = 512;

/// Whether a triangle outside of the mask blocks the segment.
bool is_blocked(const bvh::MeshBvh& bvh,
                const Segment& segment,
                const ExclusionMask& excluded) noexcept {
    bool is_blocked = false;
    bvh::traverse_front_to_back(bvh.tree(), segment, 1.0, bvh::every_slot, [&](TriangleId id) {
        is_blocked = !excluded.contains(id) && touches(segment, bvh.mesh(), id);
        return !is_blocked;
    });
    return is_blocked;
}

/// first_blocker() of a segment that is blocked by some triangle, excluded or not.
std::optional<Blocker> find_first(const bvh::MeshBvh& bvh,
                                  const Segment& segment,
                                  const ExclusionMask& excluded) noexcept {
    // Twice the error bound of geometry::first_touch: a triangle whose box begins this much later
    // may still have a smaller computed parameter.
    constexpr double kSlack = 0x1p-36;
    std::optional<Blocker> first;
    double t_max = 1.0;
    bvh::traverse_front_to_back(bvh.tree(), segment, t_max, bvh::every_slot, [&](TriangleId id) {
        if (excluded.contains(id)) {
            return true;
        }
        const auto t = first_touch(segment, bvh.mesh(), id);
        if (t && (!first || bvh::better_hit(Blocker{id, *t}, *first))) {
            first = {id, *t};
            t_max = std::min(1.0, *t + kSlack);
        }
        return true;
    });
    return first;
}

/// Queries segments in an order in which neighbours are close to each other; the answers stand in
/// the order of the segments.
template <typename Answer>
void query_sorted(const bvh::MeshBvh& bvh,
                  std::span<const Segment> segments,
                  const ExclusionMask& excluded,
                  std::span<Answer> answers,
                  Executor& executor) {
    std::vector<Segment> sorted(std::min(kBatchSize, segments.size()));
    std::vector<Answer> of_sorted(sorted.size());
    for (std::size_t begin = 0; begin < segments.size(); begin += kBatchSize) {
        const auto batch = segments.subspan(begin, std::min(kBatchSize, segments.size() - begin));
        const std::vector<std::uint32_t> order = coherent_order(batch, executor);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            sorted[i] = batch[order[i]];
        }
        query_batch(bvh,
                    std::span<const Segment>(sorted).first(batch.size()),
                    excluded,
                    std::span(of_sorted).first(batch.size()),
                    executor);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            answers[begin + order[i]] = of_sorted[i];
        }
    }
}

template <typename Answer>
std::vector<Answer> query_all(const bvh::MeshBvh& bvh,
                              std::span<const Segment> segments,
                              const ExclusionMask& excluded,
                              Executor& executor) {
    // While most of the tree stays in the caches, sorting costs more than it saves.
    constexpr std::size_t kMinBytesForSorting = std::size_t{128} << 20U;
    std::vector<Answer> answers(segments.size());
    if (bvh.tree().bytes() < kMinBytesForSorting) {
        query_batch(bvh, segments, excluded, std::span(answers), executor);
    } else {
        query_sorted(bvh, segments, excluded, std::span(answers), executor);
    }
    return answers;
}

}  // namespace

bool visible(const bvh::MeshBvh& bvh,
             const Segment& segment,
             const ExclusionMask& excluded) noexcept {
    return !bvh.occluded(segment) || (!excluded.is_empty() && !is_blocked(bvh, segment, excluded));
}

std::optional<Blocker> first_blocker(const bvh::MeshBvh& bvh,
                                     const Segment& segment,
                                     const ExclusionMask& excluded) noexcept {
    return bvh.occluded(segment) ? find_first(bvh, segment, excluded) : std::nullopt;
}

void query_batch(const bvh::MeshBvh& bvh,
                 std::span<const Segment> segments,
                 const ExclusionMask& excluded,
                 std::span<std::uint8_t> visible,
                 Executor& executor) {
    bvh.occluded(segments, visible, executor);
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const bool is_visible = visible[i] == 0 || (!excluded.is_empty() &&
                                                        !is_blocked(bvh, segments[i], excluded));
            visible[i] = is_visible ? 1 : 0;
        }
    });
}

void query_batch(const bvh::MeshBvh& bvh,
                 std::span<const Segment> segments,
                 const ExclusionMask& excluded,
                 std::span<std::optional<Blocker>> blockers,
                 Executor& executor) {
    const auto blocked = bvh.occluded(segments, executor);
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blockers[i] = blocked[i] != 0 ? find_first(bvh, segments[i], excluded) : std::nullopt;
        }
    });
}

std::vector<std::uint8_t> visible(const bvh::MeshBvh& bvh,
                                  std::span<const Segment> segments,
                                  const ExclusionMask& excluded,
                                  Executor& executor) {
    return query_all<std::uint8_t>(bvh, segments, excluded, executor);
}

std::vector<std::optional<Blocker>> first_blockers(const bvh::MeshBvh& bvh,
                                                   std::span<const Segment> segments,
                                                   const ExclusionMask& excluded,
                                                   Executor& executor) {
    return query_all<std::optional<Blocker>>(bvh, segments, excluded, executor);
}

}  // namespace earshot::visibility
