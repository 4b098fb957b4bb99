// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/propagation/coherent_sampling.h"
#include "earshot/propagation/late_energy.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Late sound of a source whose scene or listeners move, for few lines of sight per update. Rays of
/// the source leave virtual sources where they are reflected, which radiate by Lambert's law
/// (instant radiosity: Keller 1997); they have the same random numbers at every update, and what
/// does not come near anything that moved is kept. Of the virtual sources each listener tests so
/// many as its budget says, chosen by coherent_samples() by what they would bring if nothing stood
/// between; so the estimate is unbiased, and changes little from update to update.
///
/// Only the last reflection on the way to a listener is taken as diffuse; all before it are
/// scattered or specular by the material, as those of trace_late_rays(). Where surfaces scatter
/// everything both have the same mean, but for listeners nearer than 0.25 m to a surface.
class CoherentLateSound {
public:
    /// Of the options count: rays, seed, length, bin, specular_order, bands, air, air_absorption,
    /// transmission and report_directions. Throws Error if one is out of range.
    explicit CoherentLateSound(const RayOptions& options);
    ~CoherentLateSound();
    CoherentLateSound(CoherentLateSound&&) noexcept;
    CoherentLateSound& operator=(CoherentLateSound&&) noexcept;

    /// Follows the source and the scene, which must stay as they are until the last question about
    /// them. Returns how many legs of rays were traced. The virtual sources are those of a fresh
    /// start, to the bit. Precondition: always the same source, and materials that stay.
    std::size_t update(const RayScene& scene,
                       const RaySource& source,
                       Executor& executor = Executor::serial());

    /// What arrives at each listener, from at most `budget` virtual sources each. The errors of the
    /// histograms are 0. A listener's depends on no other. Precondition of this and the following:
    /// updated.
    std::vector<audio::EnergyHistogram> estimate(std::span<const geometry::Vec3> listeners,
                                                 std::size_t budget,
                                                 Executor& executor = Executor::serial()) const;

    /// Of each virtual source: what it would bring to a listener that sees it, in parts of what all
    /// would bring in its interval of 20 bins and in the band, mean over bands. So all parts of the
    /// decay and all bands count alike.
    std::vector<double> importances(const geometry::Vec3& listener) const;
    /// Of each virtual source, the same at every update.
    std::span<const SamplingKey> keys() const noexcept;
    /// What estimate() chooses.
    std::vector<WeightedSample> choose(const geometry::Vec3& listener, std::size_t budget) const;
    /// What arrives from virtual sources of one's own choice.
    audio::EnergyHistogram energy_of(const geometry::Vec3& listener,
                                     std::span<const WeightedSample> samples) const;

    /// Their number.
    std::size_t virtual_sources() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::propagation
