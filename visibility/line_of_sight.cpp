// SPDX-License-Identifier: MIT
#include "earshot/visibility/line_of_sight.h"

#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"
#include "earshot/visibility/internal/ask.h"
#include "earshot/visibility/internal/coherent_order.h"
#include "earshot/visibility/internal/segment_walk.h"

#include <algorithm>
#include <cstddef>

namespace earshot::visibility {

using bvh::WideTree;
using geometry::MeshView;
using geometry::Segment;
using geometry::TriangleId;

namespace {

constexpr std::size_t kGrain = 512;

/// Whether something that is not excluded blocks the segment.
bool is_blocked(const WideTree& tree,
                const MeshView& mesh,
                const Segment& segment,
                const ExclusionMask& excluded) noexcept {
    bool is_blocked = false;
    walk(tree, segment, 1.0, opens_all, [&](TriangleId id) {
        is_blocked = !excluded.contains(id) && touches(segment, mesh, id);
        return !is_blocked;
    });
    return is_blocked;
}

/// first_blocker() of a segment that something blocks, ignored or not.
std::optional<Blocker> find_first(const WideTree& tree,
                                  const MeshView& mesh,
                                  const Segment& segment,
                                  const ExclusionMask& excluded) noexcept {
    // A triangle whose parameter comes out first may begin this much later: twice what
    // geometry::first_touch is off at most.
    constexpr double kSlack = 0x1p-36;
    std::optional<Blocker> first;
    double most = 1.0;
    walk(tree, segment, most, opens_all, [&](TriangleId id) {
        if (excluded.contains(id)) {
            return true;
        }
        const auto t = first_touch(segment, mesh, id);
        if (t && (!first || *t < first->t || (*t == first->t && id < first->triangle))) {
            first = {id, *t};
            most = std::min(1.0, *t + kSlack);
        }
        return true;
    });
    return first;
}

/// Asks for segments in an order in which neighbours are near each other, and puts the answers in
/// the order of the segments.
template <typename Answer>
void ask_sorted(const WideTree& tree,
                const MeshView& mesh,
                std::span<const Segment> segments,
                const ExclusionMask& excluded,
                std::span<Answer> answers,
                Executor& executor) {
    std::vector<Segment> sorted(std::min(kBatch, segments.size()));
    std::vector<Answer> of_sorted(sorted.size());
    for (std::size_t begin = 0; begin < segments.size(); begin += kBatch) {
        const auto batch = segments.subspan(begin, std::min(kBatch, segments.size() - begin));
        const std::vector<std::uint32_t> order = coherent_order(batch, executor);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            sorted[i] = batch[order[i]];
        }
        ask(tree,
            mesh,
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
std::vector<Answer> ask_all(const WideTree& tree,
                            const MeshView& mesh,
                            std::span<const Segment> segments,
                            const ExclusionMask& excluded,
                            Executor& executor) {
    // Where most of the tree stays in the caches, sorting costs more than it saves.
    constexpr std::size_t kBytesWorthSorting = std::size_t{128} << 20U;
    std::vector<Answer> answers(segments.size());
    if (tree.bytes() < kBytesWorthSorting) {
        ask(tree, mesh, segments, excluded, std::span(answers), executor);
    } else {
        ask_sorted(tree, mesh, segments, excluded, std::span(answers), executor);
    }
    return answers;
}

}  // namespace

bool visible(const WideTree& tree,
             const MeshView& mesh,
             const Segment& segment,
             const ExclusionMask& excluded) noexcept {
    return !bvh::occluded(tree, mesh, segment) ||
           (!excluded.is_empty() && !is_blocked(tree, mesh, segment, excluded));
}

std::optional<Blocker> first_blocker(const WideTree& tree,
                                     const MeshView& mesh,
                                     const Segment& segment,
                                     const ExclusionMask& excluded) noexcept {
    return bvh::occluded(tree, mesh, segment) ? find_first(tree, mesh, segment, excluded)
                                              : std::nullopt;
}

void ask(const WideTree& tree,
         const MeshView& mesh,
         std::span<const Segment> segments,
         const ExclusionMask& excluded,
         std::span<std::uint8_t> seen,
         Executor& executor) {
    bvh::occluded(tree, mesh, segments, seen, executor);
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const bool is_free = seen[i] == 0 || (!excluded.is_empty() &&
                                                  !is_blocked(tree, mesh, segments[i], excluded));
            seen[i] = is_free ? 1 : 0;
        }
    });
}

void ask(const WideTree& tree,
         const MeshView& mesh,
         std::span<const Segment> segments,
         const ExclusionMask& excluded,
         std::span<std::optional<Blocker>> blockers,
         Executor& executor) {
    const auto blocked = bvh::occluded(tree, mesh, segments, executor);
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blockers[i] =
                blocked[i] != 0 ? find_first(tree, mesh, segments[i], excluded) : std::nullopt;
        }
    });
}

std::vector<std::uint8_t> visible(const WideTree& tree,
                                  const MeshView& mesh,
                                  std::span<const Segment> segments,
                                  const ExclusionMask& excluded,
                                  Executor& executor) {
    return ask_all<std::uint8_t>(tree, mesh, segments, excluded, executor);
}

std::vector<std::optional<Blocker>> first_blockers(const WideTree& tree,
                                                   const MeshView& mesh,
                                                   std::span<const Segment> segments,
                                                   const ExclusionMask& excluded,
                                                   Executor& executor) {
    return ask_all<std::optional<Blocker>>(tree, mesh, segments, excluded, executor);
}

}  // namespace earshot::visibility
