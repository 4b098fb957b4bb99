// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/binned_sah.h"
#include "earshot/bvh/internal/builders.h"

namespace earshot::bvh {

Tree build_binned_sah(std::span<const geometry::Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor) {
    return build_binned(boxes,
                        {.max_leaf_size = static_cast<std::uint32_t>(options.max_leaf_size),
                         .traversal_cost = static_cast<float>(options.traversal_cost),
                         .spatial_median = false},
                        executor);
}

}  // namespace earshot::bvh
