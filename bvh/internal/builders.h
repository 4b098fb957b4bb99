// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

namespace earshot::bvh {

// One function per Builder. Preconditions: there are boxes, and the options are in range. The tree
// depends on boxes and options alone, never on the executor or the SIMD target.

Tree build_binned_sah(std::span<const geometry::Aabb> boxes,
                      const BuildOptions& options,
                      Executor& executor);

/// binned_sah where there are rays.
Tree build_ray_distribution(std::span<const geometry::Aabb> boxes,
                            const BuildOptions& options,
                            Executor& executor);

/// The share that counts of rays have in the probability that a node is visited, when `rays` of the
/// sample meet its parent.
double weight_of_rays(std::size_t rays) noexcept;

Tree build_sweep_sah(std::span<const geometry::Aabb> boxes,
                     const BuildOptions& options,
                     Executor& executor);

Tree build_spatial_median(std::span<const geometry::Aabb> boxes,
                          const BuildOptions& options,
                          Executor& executor);

Tree build_quality(std::span<const geometry::Aabb> boxes,
                   const BuildOptions& options,
                   Executor& executor);

Tree build_lbvh(std::span<const geometry::Aabb> boxes,
                const BuildOptions& options,
                Executor& executor);

Tree build_hybrid(std::span<const geometry::Aabb> boxes,
                  const BuildOptions& options,
                  Executor& executor);

Tree build_fast(std::span<const geometry::Aabb> boxes,
                const BuildOptions& options,
                Executor& executor);

}  // namespace earshot::bvh
