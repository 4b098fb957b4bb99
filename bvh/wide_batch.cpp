// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_batch.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/wide_batch_kernel.h"

#include <algorithm>
#include <atomic>

namespace earshot::bvh {

using geometry::Hit;
using geometry::Ray;
using geometry::Segment;

namespace {

constexpr std::size_t kGrain = 4096;

/// Calls work(begin, end) for parts of [0, count) until it is interrupted.
template <typename Work>
bool for_each_part(std::size_t count,
                   Executor& executor,
                   const Interrupt& interrupt,
                   const Work& work) {
    std::atomic<bool> is_stopped = false;
    executor.for_each(count, kGrain, [&](std::size_t begin, std::size_t end) {
        if (interrupt && (is_stopped || interrupt())) {
            is_stopped = true;
            return;
        }
        work(begin, end);
    });
    return !is_stopped;
}

}  // namespace

bool closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  std::span<const Ray> rays,
                  std::span<std::optional<Hit>> hits,
                  Executor& executor,
                  const Interrupt& interrupt) {
    EARSHOT_ASSERT(rays.size() == hits.size());
    if (tree.nodes().empty()) {
        std::fill(hits.begin(), hits.end(), std::nullopt);
        return true;
    }
    return for_each_part(rays.size(), executor, interrupt, [&](std::size_t begin, std::size_t end) {
        find_closest_of_many(
            tree, mesh, {rays.subspan(begin, end - begin), {}}, hits.subspan(begin, end - begin));
    });
}

std::vector<std::optional<Hit>> closest_hits(const WideTree& tree,
                                             const geometry::MeshView& mesh,
                                             std::span<const Ray> rays,
                                             Executor& executor) {
    std::vector<std::optional<Hit>> hits(rays.size());
    closest_hits(tree, mesh, rays, hits, executor);
    return hits;
}

bool occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              std::span<const Segment> segments,
              std::span<std::uint8_t> blocked,
              Executor& executor,
              const Interrupt& interrupt) {
    EARSHOT_ASSERT(segments.size() == blocked.size());
    if (tree.nodes().empty()) {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
        return true;
    }
    return for_each_part(
        segments.size(), executor, interrupt, [&](std::size_t begin, std::size_t end) {
            find_any_of_many(tree,
                             mesh,
                             {segments.subspan(begin, end - begin), {}},
                             blocked.subspan(begin, end - begin));
        });
}

std::vector<std::uint8_t> occluded(const WideTree& tree,
                                   const geometry::MeshView& mesh,
                                   std::span<const Segment> segments,
                                   Executor& executor) {
    std::vector<std::uint8_t> blocked(segments.size());
    occluded(tree, mesh, segments, blocked, executor);
    return blocked;
}

void closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  const SecondaryRays& secondary,
                  std::span<std::optional<Hit>> hits) {
    EARSHOT_ASSERT(secondary.rays.size() == hits.size() &&
                   secondary.origin_triangles.size() == hits.size());
    if (tree.nodes().empty()) {
        std::fill(hits.begin(), hits.end(), std::nullopt);
        return;
    }
    find_closest_of_many(tree, mesh, secondary, hits);
}

void occluded(const WideTree& tree,
              const geometry::MeshView& mesh,
              const SecondarySegments& secondary,
              std::span<std::uint8_t> blocked) {
    EARSHOT_ASSERT(secondary.segments.size() == blocked.size() &&
                   secondary.origin_triangles.size() == blocked.size());
    if (tree.nodes().empty()) {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
        return;
    }
    find_any_of_many(tree, mesh, secondary, blocked);
}

}  // namespace earshot::bvh
