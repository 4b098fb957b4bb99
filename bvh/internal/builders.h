// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <cstddef>
#include <cstdint>
#include <span>

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

/// The weight of ray counts, against areas, in the probability that a node is visited when `rays`
/// of the sample hit its parent (Bittner and Havran 2009).
double ray_blend_weight(std::size_t rays) noexcept;

Tree build_sweep_sah(std::span<const geometry::Aabb> boxes,
                     const BuildOptions& options,
                     Executor& executor);

/// SAH costs of the splits of a sorted range, times the half area of its box: element j is the cost
/// of the split with the boxes order[0 ... j - 1] on the left, for 0 < j < order.size(), and
/// element 0 that of no split. Both sides count as leaves: their number of boxes times their half
/// area.
void sweep_costs(std::span<const geometry::Aabb> boxes,
                 std::span<const std::uint32_t> order,
                 std::span<double> costs);

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
