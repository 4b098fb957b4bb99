// SPDX-License-Identifier: MIT
#include "earshot/visibility/pvs_validation.h"

#include "earshot/base/assert.h"
#include "earshot/visibility/internal/masked_hits.h"
#include "earshot/visibility/internal/random_ray.h"

#include <algorithm>
#include <optional>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;

namespace {

constexpr std::size_t kRaysPerBatch = std::size_t{1} << 16U;
constexpr std::size_t kRaysPerChunk = 4096;

// The first of the streams of random numbers, none of which any sampling uses: the rays are
// independent of the sets.
constexpr std::uint64_t kFirstStream = 200;

}  // namespace

MissedShare validate_pvs(const bvh::MeshBvh& bvh,
                         const Objects& objects,
                         const ViewCells& cells,
                         std::span<const std::vector<ObjectId>> sets,
                         const ValidationOptions& options,
                         Executor& executor) {
    EARSHOT_ASSERT(sets.size() == cells.size());
    const ExclusionMask excluded = with_degenerate(options.excluded, bvh.mesh());
    MissedShare result;
    std::vector<Ray> rays;
    std::vector<std::optional<Hit>> hits;
    while (result.rays < options.rays) {
        const auto count = static_cast<std::size_t>(
            std::min<std::uint64_t>(kRaysPerBatch, options.rays - result.rays));
        rays.resize(count);
        hits.resize(count);
        executor.for_each(count, kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                rays[i] = random_ray(cells.region(), options.seed, kFirstStream, result.rays + i);
            }
        });
        closest_hits(bvh, rays, excluded, hits, executor);
        for (std::size_t i = 0; i < count; ++i) {
            const auto cell = cells.cell_at(rays[i].origin);
            if (hits[i] && cell) {
                const std::vector<ObjectId>& set = sets[*cell];
                const ObjectId object = objects.of(hits[i]->triangle);
                result.missed += std::binary_search(set.begin(), set.end(), object) ? 0 : 1;
            }
        }
        result.rays += count;
        if (options.progress != nullptr) {
            options.progress->report("validation rays", result.rays, options.rays);
        }
    }
    return result;
}

}  // namespace earshot::visibility
