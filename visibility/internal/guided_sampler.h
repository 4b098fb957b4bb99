// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/internal/border_sampling.h"
#include "earshot/visibility/region_pvs.h"

#include <array>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Casts rays in batches. The hits of a batch, in their order, determine the rays of the next
/// batch.
class GuidedSampler {
public:
    GuidedSampler(const bvh::MeshBvh& bvh,
                  const ViewRegion& region,
                  const GuidedSamplingOptions& options,
                  Executor& executor);

    /// Samples until a limit of the options is reached. The result lacks its triangles and
    /// witnesses.
    RegionPvs run();

    /// The excluded triangles, including those without area.
    const ExclusionMask& excluded() const noexcept { return excluded_; }

    bool is_known(geometry::TriangleId triangle) const noexcept {
        return index_of_triangle_[triangle] != kUnknown;
    }
    /// Precondition: is_known(triangle).
    const geometry::Ray& witness_of(geometry::TriangleId triangle) const noexcept {
        return witnesses_[index_of_triangle_[triangle]];
    }

private:
    static constexpr std::uint32_t kUnknown = 0xffffffffU;

    /// A triangle whose border is to be sampled, as seen from the origin of a ray that hit it.
    struct Seed {
        geometry::Vec3 eye{}, hit_point{};
        geometry::TriangleId triangle = 0;
    };
    /// A ray past the border of a seed's triangle, and its hit.
    struct BorderSample {
        std::size_t seed = 0;
        geometry::Vec3 target{};
        std::optional<geometry::Hit> hit{};
        geometry::Vec3 hit_point{};
    };
    /// Neighbouring samples along a border with a discontinuity between them.
    struct BorderInterval {
        BorderSample left{}, right{};
    };

    bool is_finished() const;
    /// The number of rays, at most `rays`, that may be cast without exceeding `max_rays`.
    std::size_t rays_allowed(std::size_t rays) const;
    /// Casts as many of the rays as are allowed, records their hits, and returns their number.
    std::size_t cast(std::span<const geometry::Ray> rays);
    void record(const geometry::Ray& ray, const std::optional<geometry::Hit>& hit);
    geometry::Ray random_ray(std::uint64_t index) const;
    std::size_t batch_size() const;
    void cast_random();
    void reseed_known_triangles();

    void sample_borders(std::span<const Seed> seeds);
    void cast_samples(std::span<const Seed> seeds, std::vector<BorderSample>& samples);
    std::vector<BorderInterval> subdivide(std::span<const Seed> seeds,
                                          const std::vector<BorderInterval>& intervals);
    bool is_discontinuous(const BorderSample& a, const BorderSample& b) const;
    void sample_reverse(const Seed& seed, const BorderSample& sample);

    bvh::MeshBvh bvh_;
    ViewRegion region_;
    const GuidedSamplingOptions& options_;
    Executor& executor_;
    ExclusionMask excluded_;  // includes the triangles without area
    double diagonal_ = 0.0;
    std::array<double, 6> face_areas_{};  // of the region's faces, cumulative

    std::vector<std::uint32_t> index_of_triangle_;  // into witnesses_, or kUnknown
    std::vector<geometry::Ray> witnesses_;
    std::vector<geometry::TriangleId> found_;  // the triangle of each witness
    std::deque<Seed> queue_;
    std::vector<geometry::Ray> reverse_rays_;         // to be cast after the current seeds
    std::vector<std::optional<geometry::Hit>> hits_;  // of the last batch
    std::uint64_t rays_ = 0;
    std::uint64_t random_rays_ = 0;
    std::uint64_t reseeds_ = 0;
    std::vector<RegionPvs::Point> curve_;
    bool is_interrupted_ = false;
};

}  // namespace earshot::visibility
