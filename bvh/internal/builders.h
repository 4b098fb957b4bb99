// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

namespace earshot::bvh {

// One function per Builder. Preconditions: there are boxes, and the options are in range. The tree
// depends on boxes and options alone, never on the executor or the SIMD target.

Tree build_binned_sah(std::span<const geometry::Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor);

Tree build_sweep_sah(std::span<const geometry::Aabb> boxes,
                     const BuildOptions& options,
                     Executor& executor);

Tree build_spatial_median(std::span<const geometry::Aabb> boxes,
                          const BuildOptions& options,
                          Executor& executor);

}  // namespace earshot::bvh
