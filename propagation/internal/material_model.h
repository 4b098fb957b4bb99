// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/room_metrics.h"
#include "earshot/propagation/internal/pair_energies.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

inline constexpr std::size_t kMetricCount = audio::kBandMetricKinds.size();

/// One number for each of kBandMetricKinds.
using MetricVector = std::array<double, kMetricCount>;

/// Metrics of one band and their derivatives by each coefficient.
struct ModelledMetrics {
    std::array<std::optional<double>, kMetricCount> values{};
    std::vector<MetricVector> derivatives{};  ///< one each; 0 of metrics without a value
};

/// What the metrics of a simulated pair become with other materials, without another simulation.
/// Each reflection stands with a factor 1 - absorption, and with 1 - scattering or scattering, as
/// it is specular or scattered, so paths are exact. Late energy changes in each interval with the
/// rate that follows from its mean numbers of reflections, which is exact to first order: as a
/// power of 1 - absorption, and exponentially with the logarithm of scattering.
class MaterialModel {
public:
    /// `scene` is that of the simulation. Precondition: the pair has paths, and materials of its
    /// late energy.
    MaterialModel(const Scene& scene, PairResult pair, const audio::Bands& bands);

    /// `coefficients` of this band: the absorption of each material, below 1 unless it is as
    /// simulated, and then, or not, the scattering of each, within 0 ... 1 likewise. Precondition:
    /// the late energy has scatterings if scattering is given.
    ModelledMetrics evaluate(std::size_t band, std::span<const double> coefficients) const;

    /// By how much the metrics of each replicate of the rays differ from those of all, to first
    /// order (infinitesimal jackknife, Efron and Tibshirani 1993, section 20.5); 0 of metrics
    /// without a value. Empty with fewer than two replicates.
    std::vector<MetricVector> ray_deviations(std::size_t band) const;

private:
    /// What the rays tell of one band.
    struct Rays {
        /// Interval, material: mean number of reflections of the energy.
        std::vector<double> reflections;
        /// Likewise: relative change of the energy per unit of scattering; empty if it is not
        /// known.
        std::vector<double> scattering_rates;
    };
    /// Factors of the energy of each arrival and interval.
    struct Factors {
        std::vector<double> arrivals, intervals;
    };
    Rays rays_of(std::size_t band) const;
    Factors factors(const Rays& rays, std::size_t band, std::span<const double> coefficients) const;
    bool is_perfect(std::size_t coefficient, std::span<const double> coefficients) const;
    /// Changes of the energies per unit of a coefficient, from those at the coefficients.
    void read_rates(const Rays& rays,
                    std::size_t band,
                    std::size_t coefficient,
                    std::span<const double> coefficients,
                    std::span<double> of_arrivals,
                    std::span<double> of_bins) const;
    /// The band alone; the others are silent.
    std::vector<audio::Arrival> arrivals_of_band(std::size_t band,
                                                 std::span<const double> factors) const;
    audio::EnergyHistogram late_of_band(std::size_t band, std::span<const double> factors) const;

    const audio::Bands& bands_;
    std::size_t materials_;
    std::vector<audio::Spectrum> simulated_;  // absorption of each material, then scattering
    std::unique_ptr<const PairResult> pair_;  // what the energies refer to
    PairEnergies energies_;
};

}  // namespace earshot::propagation
