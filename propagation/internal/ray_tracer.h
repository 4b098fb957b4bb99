// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/propagation/late_rays.h"

#include <span>
#include <vector>

namespace earshot::propagation {

/// What a batch of rays brings home.
struct RayTally {
    std::vector<double> energy;      ///< listener after listener, bin after bin, band after band
    std::vector<double> directions;  ///< listener, span, part, band; empty where nobody asked
    EnergyBalance balance;
    double cubed_first_legs = 0.0;  ///< sum over rays that hit something, cubic metres
};

/// What becomes of sound at a surface.
struct RaySurface {
    /// Shares of what arrives, per band.
    audio::Spectrum absorbed{}, mirrored{}, scattered{}, through{};
    audio::Spectrum kept{};  ///< mirrored + scattered + through
    bool one_sided = false;
    /// What is kept is shared out alike in every band: then a ray's chances do not depend on it.
    bool is_even = false;
    double chance_scattered = 0.0, chance_through = 0.0;  ///< if so
    double chance_heard = 0.0;                            ///< likewise: of rain
};

/// A listener as rays meet it.
struct RayEar {
    geometry::Vec3 position;
    double radius_squared = 0.0;
    double inverse_volume = 0.0;  ///< of the sphere
};

/// Follows rays of one source through one scene. Only reads what it was given, which must outlive
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

    /// A triangle as a ray meets it.
    struct Wall {
        geometry::Vec3 normal;
        std::uint32_t surface = 0;
    };

    void describe_surfaces();
    void describe_walls();
    double radius_for_space() const;
    geometry::Vec3 direction_of(std::uint64_t id, double count) const;

    const RayScene& scene_;
    const RaySource& source_;
    const RayOptions& options_;
    bvh::WideTree wide_;
    std::size_t bands_;
    double reach_;  // metres that sound travels until the histogram ends
    double bins_per_metre_;
    std::size_t bins_;
    double lift_;
    std::vector<RaySurface> surfaces_;  // per material
    std::vector<Wall> walls_;           // per triangle
    std::vector<RayEar> ears_;          // per listener
};

}  // namespace earshot::propagation
