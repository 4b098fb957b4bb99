// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/bin_cuts.h"
#include "earshot/bvh/internal/builders.h"

namespace earshot::bvh {

Tree build_binned_sah(std::span<const geometry::Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor) {
    return build_by_bins(boxes,
                         {.leaf_size = static_cast<std::uint32_t>(options.leaf_size),
                          .traversal_cost = static_cast<float>(options.traversal_cost),
                          .at_middle = false},
                         executor);
}

}  // namespace earshot::bvh
