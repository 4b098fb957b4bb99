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

/// Metrics of one band and their derivatives by the absorption of each material.
struct ModelledMetrics {
    std::array<std::optional<double>, kMetricCount> values{};
    std::vector<MetricVector> derivatives{};  ///< one per material; 0 of metrics without a value
};

/// What the metrics of a simulated pair become with other absorption coefficients, without another
/// simulation. Each reflection stands with a factor 1 - absorption, so paths are exact; late energy
/// is scaled by that factor to the power of the mean number of reflections in its interval, which
/// is exact to first order.
class AbsorptionModel {
public:
    /// `scene` is that of the simulation. Precondition: the pair has paths, and materials of its
    /// late energy.
    AbsorptionModel(const Scene& scene, PairResult pair, const audio::Bands& bands);

    /// `absorption`: of each material in this band, below 1 unless it is as simulated.
    ModelledMetrics evaluate(std::size_t band, std::span<const double> absorption) const;

    /// By how much the metrics of each replicate of the rays differ from those of all, to first
    /// order (infinitesimal jackknife, Efron and Tibshirani 1993, section 20.5); 0 of metrics
    /// without a value. Empty with fewer than two replicates.
    std::vector<MetricVector> ray_deviations(std::size_t band) const;

private:
    /// Factors of the energy of each arrival and interval.
    struct Factors {
        std::vector<double> arrivals, intervals;
    };
    Factors factors(std::size_t band, std::span<const double> absorption) const;
    double mean_reflections(std::size_t interval, std::size_t material, std::size_t band) const {
        return mean_reflections_[(interval * materials_ + material) * bands_.count() + band];
    }
    /// The band alone; the others are silent.
    std::vector<audio::Arrival> arrivals_of_band(std::size_t band,
                                                 std::span<const double> factors) const;
    audio::EnergyHistogram late_of_band(std::size_t band, std::span<const double> factors) const;

    const audio::Bands& bands_;
    std::size_t materials_;
    std::vector<audio::Spectrum> absorption_;  // per material, as simulated
    std::unique_ptr<const PairResult> pair_;   // what the energies refer to
    PairEnergies energies_;
    std::vector<double> mean_reflections_;  // interval, material, band
};

}  // namespace earshot::propagation
