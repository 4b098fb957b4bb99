// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/internal/builders.h"

namespace earshot::bvh {

// Lauterbach 2010, section 4.2: every range is split in the middle of the longest side of its box,
// by the centroids of its primitives; at the median where all of them would go to one side.
Tree build_spatial_median(std::span<const geometry::Aabb> boxes,
                          const BuildOptions& options,
                          Executor& executor) {
    return build_binned(boxes,
                        {.max_leaf_size = static_cast<std::uint32_t>(options.max_leaf_size),
                         .spatial_median = true},
                        executor);
}

}  // namespace earshot::bvh
