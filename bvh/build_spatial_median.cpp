// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/bin_cuts.h"
#include "earshot/bvh/internal/builders.h"

namespace earshot::bvh {

// Lauterbach 2010, section 4.2: every box is cut in the middle of its longest side, and boxes go by
// their centres; by count where all of them would go to one side.
Tree build_spatial_median(std::span<const geometry::Aabb> boxes,
                          const BuildOptions& options,
                          Executor& executor) {
    return build_by_bins(
        boxes,
        {.leaf_size = static_cast<std::uint32_t>(options.leaf_size), .at_middle = true},
        executor);
}

}  // namespace earshot::bvh
