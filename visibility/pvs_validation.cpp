// SPDX-License-Identifier: MIT
#include "earshot/visibility/pvs_validation.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/masked_hits.h"

#include <algorithm>
#include <optional>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr std::size_t kRaysPerBatch = std::size_t{1} << 16U;
constexpr std::size_t kRaysPerChunk = 4096;

// Streams of random numbers, none of which any sampling uses: the rays are independent of the sets.
constexpr std::uint64_t kOrigin = 200;  // and the next two
constexpr std::uint64_t kHeight = 203;
constexpr std::uint64_t kTurn = 204;

Ray validation_ray(const ViewRegion& region, std::uint64_t seed, std::uint64_t index) {
    Ray ray;
    for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = random_between(seed,
                                          kOrigin + static_cast<std::uint64_t>(axis),
                                          index,
                                          region.lower[axis],
                                          region.upper[axis]);
    }
    ray.direction = on_sphere(random_between(seed, kHeight, index, -1.0, 1.0),
                              2.0 * math::kPi * random(seed, kTurn, index));
    return ray;
}

}  // namespace

MissedShare validate_pvs(const bvh::WideTree& tree,
                         const geometry::MeshView& mesh,
                         const Objects& objects,
                         const ViewCells& cells,
                         std::span<const std::vector<ObjectId>> sets,
                         const ValidationOptions& options,
                         Executor& executor) {
    EARSHOT_ASSERT(sets.size() == cells.size());
    const ExclusionMask excluded = with_degenerate(options.excluded, mesh);
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
                rays[i] = validation_ray(cells.region(), options.seed, result.rays + i);
            }
        });
        closest_hits(tree, mesh, rays, excluded, hits, executor);
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
