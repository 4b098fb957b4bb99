// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_batch.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/wide_batch_kernel.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::Hit;
using geometry::Ray;

namespace {

constexpr std::size_t kGrain = 4096;

}  // namespace

void closest_hits(const WideTree& tree,
                  const geometry::MeshView& mesh,
                  std::span<const Ray> rays,
                  std::span<std::optional<Hit>> hits,
                  Executor& executor) {
    EARSHOT_ASSERT(rays.size() == hits.size());
    if (tree.nodes().empty()) {
        std::fill(hits.begin(), hits.end(), std::nullopt);
        return;
    }
    executor.for_each(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        find_closest_of_many(
            tree, mesh, rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
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

std::vector<std::uint8_t> occluded(const WideTree& tree,
                                   const geometry::MeshView& mesh,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor) {
    std::vector<std::uint8_t> blocked(segments.size(), 0);
    if (tree.nodes().empty()) {
        return blocked;
    }
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        find_any_of_many(tree,
                         mesh,
                         segments.subspan(begin, end - begin),
                         std::span(blocked).subspan(begin, end - begin));
    });
    return blocked;
}

}  // namespace earshot::bvh
