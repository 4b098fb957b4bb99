// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/guided_sampling.h"
#include "earshot/visibility/internal/border_sampling.h"

#include <array>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Casts rays in batches, and decides on the next ones from what the last ones met, in order.
class GuidedSampler {
public:
    GuidedSampler(const bvh::WideTree& tree,
                  const geometry::MeshView& mesh,
                  const ViewRegion& region,
                  const GuidedSamplingOptions& options,
                  Executor& executor);

    /// Until it is enough; the triangles and witnesses of the result are left out.
    RegionPvs run();

    bool is_known(geometry::TriangleId triangle) const noexcept {
        return place_[triangle] != kUnknown;
    }
    /// Precondition: is_known(triangle).
    const geometry::Ray& witness_of(geometry::TriangleId triangle) const noexcept {
        return witnesses_[place_[triangle]];
    }

private:
    static constexpr std::uint32_t kUnknown = 0xffffffffU;

    /// A triangle whose border is to be sampled, seen from where a ray met it.
    struct Seed {
        geometry::Vec3 eye{}, hit{};
        geometry::TriangleId triangle = 0;
    };
    /// A ray by a border, and what it met.
    struct Probe {
        std::size_t seed = 0;
        geometry::Vec3 towards{};
        std::optional<geometry::Hit> met{};
        geometry::Vec3 hit{};
    };
    struct Gap {
        Probe left{}, right{};
    };

    bool is_finished() const;
    std::size_t allowance(std::size_t rays) const;
    /// Casts as many as are allowed and notes what they meet.
    std::size_t cast(std::span<const geometry::Ray> rays);
    void note(const geometry::Ray& ray, const std::optional<geometry::Hit>& met);
    geometry::Ray random_ray(std::uint64_t index) const;
    std::size_t batch_size() const;
    void cast_random();
    void look_again();

    void sample_borders(std::span<const Seed> seeds);
    void cast_probes(std::span<const Seed> seeds, std::vector<Probe>& probes);
    std::vector<Gap> halve(std::span<const Seed> seeds, const std::vector<Gap>& gaps);
    bool falls_apart(const Probe& a, const Probe& b) const;
    void look_past(const Seed& seed, const Probe& probe);
    Corners corners_of(geometry::TriangleId triangle) const;

    const bvh::WideTree& tree_;
    geometry::MeshView mesh_;
    ViewRegion region_;
    const GuidedSamplingOptions& options_;
    Executor& executor_;
    double diagonal_ = 0.0;
    std::array<double, 6> faces_{};  // of the region, areas summed up

    std::vector<std::uint32_t> place_;  // per triangle, among the witnesses
    std::vector<geometry::Ray> witnesses_;
    std::vector<geometry::TriangleId> found_;  // of each witness
    std::deque<Seed> waiting_;
    std::vector<geometry::Ray> past_;  // rays past blockers that are still to be cast
    std::vector<std::optional<geometry::Hit>> hits_;  // of the last batch
    std::uint64_t rays_ = 0;
    std::uint64_t random_rays_ = 0;
    std::uint64_t looks_ = 0;
    struct Mark {
        std::uint64_t rays, random_rays, random_finds;
    };
    std::uint64_t random_finds_ = 0;
    std::vector<Mark> marks_;  // after every batch
    std::vector<RegionPvs::Point> curve_;
    bool is_interrupted_ = false;
};

}  // namespace earshot::visibility
