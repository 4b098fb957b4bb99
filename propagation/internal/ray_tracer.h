// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/propagation/internal/near_field.h"
#include "earshot/propagation/internal/ray_surface.h"
#include "earshot/propagation/late_energy.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Rays of a batch, at most; numbers are drawn for (batch, ray).
inline constexpr std::uint64_t kMaxBatchRays = 2048;

/// The result of a batch of rays.
struct RayTally {
    std::vector<double> energy;      ///< listener after listener, bin after bin, band after band
    std::vector<double> directions;  ///< listener, span, part, band; empty where nobody asked
    EnergyBalance balance;
    double visible_volume = 0.0;  ///< of the source, cubic metres
};

/// A listener as rays see it: a ball about it measures the energy density of specular legs, and the
/// surfaces near it that of scattered sound.
struct Receiver {
    geometry::Vec3 position;
    double radius_squared = 0.0;
    double inverse_volume = 0.0;  ///< of the part of the ball that is visible from the listener
    std::optional<NearField> near_field{};  ///< empty where nothing scatters nearby
};

/// Traces rays of one source through one scene. Only reads what it was given, which must outlive
/// it; const members may be called from many threads at once.
class RayTracer {
public:
    RayTracer(const RayScene& scene,
              const RaySource& source,
              std::span<const geometry::Vec3> listeners,
              const RayOptions& options,
              Executor& executor);

    std::size_t bins() const noexcept { return bins_; }
    std::size_t spans() const noexcept;

    /// Batch `index`, which has `rays` rays and the whole energy of the source: a replicate of the
    /// experiment, independent of other batches.
    RayTally trace(std::uint64_t index, std::uint64_t rays) const;

private:
    template <std::size_t kBands>
    friend class RayBatch;

    /// Sound that the source sends to a place near a listener, which scatters it to the listener.
    struct DirectScattering {
        std::uint32_t listener = 0;
        double travelled = 0.0;       // metres
        geometry::Vec3 towards{0.0};  // from the listener
        audio::Spectrum energy{};
    };

    /// What a ray needs to know of a triangle.
    struct TriangleSurface {
        geometry::Vec3 normal;
        std::uint32_t surface = 0;
    };

    double roulette_threshold(double travelled) const noexcept {
        const double step = std::min(travelled, max_distance_) * roulette_steps_per_metre_;
        return roulette_thresholds_[static_cast<std::size_t>(step)];
    }
    void describe_surfaces();
    void describe_triangles();
    void describe_receivers(std::span<const geometry::Vec3> listeners, Executor& executor);
    void index_near_fields();
    void limit_roulette();
    void find_direct_scattering(Executor& executor);

    const RayScene& scene_;
    const RaySource& source_;
    const RayOptions& options_;
    bvh::WideTree wide_;
    std::size_t bands_;
    double max_distance_;  // metres that sound travels until the histogram ends
    double bins_per_metre_;
    std::size_t bins_;
    double self_intersection_offset_;
    std::vector<RaySurface> surfaces_;                // per material
    std::vector<TriangleSurface> triangle_surfaces_;  // per triangle
    std::vector<Receiver> receivers_;                 // per listener
    /// Listeners whose near field has the triangle: entries of near_receivers_.
    std::vector<std::uint32_t> first_near_receiver_;  // per triangle, and the end; or empty
    std::vector<std::uint32_t> near_receivers_;
    std::vector<DirectScattering> direct_scattering_;
    /// Russian roulette begins below this share of a ray's first energy, per step of distance.
    std::vector<double> roulette_thresholds_;
    double roulette_steps_per_metre_ = 0.0;
};

}  // namespace earshot::propagation
