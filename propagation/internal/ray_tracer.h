// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/propagation/late_energy.h"

#include <span>
#include <vector>

namespace earshot::propagation {

/// The result of a batch of rays.
struct RayTally {
    std::vector<double> energy;      ///< listener after listener, bin after bin, band after band
    std::vector<double> directions;  ///< listener, span, part, band; empty where nobody asked
    EnergyBalance balance;
    double cubed_first_distances = 0.0;  ///< sum over rays that hit something, cubic metres
};

/// How a material splits sound that arrives.
struct RaySurface {
    /// Shares of what arrives, per band.
    audio::Spectrum absorbed{}, specular{}, scattered{}, transmitted{};
    audio::Spectrum kept{};  ///< specular + scattered + transmitted
    bool one_sided = false;
    /// Every band splits alike: then the branching probabilities do not depend on the ray.
    bool uniform_split = false;
    double scattering_probability = 0.0, transmission_probability = 0.0;  ///< if so
    double rain_probability = 0.0;                                        ///< likewise
};

/// The sphere about a listener whose chords measure the energy density.
struct ReceiverSphere {
    geometry::Vec3 position;
    double radius_squared = 0.0;
    double inverse_volume = 0.0;  ///< of the sphere
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

    /// Rays begin ... end - 1 of options.rays.
    RayTally trace(std::uint64_t begin, std::uint64_t end) const;

private:
    template <std::size_t kBands>
    friend class RayBatch;

    /// What a ray needs to know of a triangle.
    struct TriangleSurface {
        geometry::Vec3 normal;
        std::uint32_t surface = 0;
    };

    void describe_surfaces();
    void describe_triangles();
    double default_radius() const;
    geometry::Vec3 direction_of(std::uint64_t id, double count) const;

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
    std::vector<ReceiverSphere> receivers_;           // per listener
};

}  // namespace earshot::propagation
