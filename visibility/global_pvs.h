// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/objects.h"

#include <array>
#include <cstdint>
#include <vector>

namespace earshot::visibility {

/// The distributions that sample rays are drawn from.
enum class SampleDistribution {
    view_space_direction,      ///< origin uniform in the region, direction uniform on the sphere
    object_surface_direction,  ///< origin uniform on an object, direction cosine-weighted
    two_point,                 ///< from a point of the region to a point on an object
    two_point_mutation,        ///< both ends of a contributing sample moved by a Gaussian
    silhouette_mutation        ///< past the silhouette of the object that a sample hit
};

inline constexpr std::size_t kSampleDistributions = 5;

/// Parameters of adaptive global visibility sampling.
struct GlobalSamplingOptions {
    std::uint64_t seed = 1;
    std::uint64_t max_rays = 20'000'000;  ///< a sample takes two
    /// Sampling ends when in `window` rays no cell's PVS grew by more than `max_growth` objects.
    std::uint64_t window = 5'000'000;
    std::uint64_t max_growth = 5;
    std::size_t samples_per_batch = std::size_t{1} << 16U;
    /// Which distributions may be drawn from, by SampleDistribution; for comparisons.
    std::array<bool, kSampleDistributions> distributions = {true, true, true, true, true};
    ExclusionMask excluded{};      ///< triangles that are treated as absent
    Progress* progress = nullptr;  ///< receives "rays"
    Interrupt interrupt{};         ///< checked between batches; an interrupted result is partial
};

/// The potentially visible sets (PVS) of all cells of a region as sampled: subsets of the true sets
/// (aggressive sets).
struct GlobalPvs {
    std::vector<std::vector<ObjectId>> visible;  ///< per cell, ascending
    std::uint64_t rays = 0;
    struct Point {
        std::uint64_t rays, entries;
    };
    std::vector<Point> curve;  ///< total size of the sets after every batch
    struct Count {
        std::uint64_t samples = 0;
        std::uint64_t contribution = 0;  ///< entries that these samples added
    };
    std::array<Count, kSampleDistributions> counts{};
};

}  // namespace earshot::visibility
