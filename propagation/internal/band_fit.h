// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/coefficient_prior.h"
#include "earshot/propagation/internal/identifiability.h"
#include "earshot/propagation/internal/material_model.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A measured metric of the band that is fitted.
struct BandDatum {
    std::size_t pair = 0;  ///< index of the pair's model
    std::size_t kind = 0;  ///< index into audio::kBandMetricKinds
    double value = 0.0;
    double error = 0.0;  ///< standard error, > 0
};

/// The fit of one band.
struct BandFitProblem {
    std::size_t band = 0;
    std::span<const MaterialModel> models{};
    std::vector<BandDatum> data{};  ///< ordered by pair
    /// As simulated: the absorption of each material, and then, if it is fitted, the scattering of
    /// each.
    std::vector<double> coefficients{};
    std::vector<CoefficientPrior> priors{};          ///< of each; deviation 0: fixed
    std::vector<double> min_values{}, max_values{};  ///< of each
    double outlier_limit = 2.5;
};

struct BandFit {
    std::vector<std::size_t> parameters{};  ///< indices of the coefficients that were fitted
    std::vector<double> coefficients{};     ///< all of them
    std::vector<bool> is_at_bound{};        ///< per parameter
    /// Of the parameters in units of their priors' deviations.
    std::optional<Identifiability> identifiability{};
    /// Per datum: of the model as simulated, and its standard error for the chance of the rays.
    std::vector<std::optional<double>> values{};
    std::vector<double> model_errors{};
    std::vector<double> weights{};  ///< per datum; 0 where the model has no value
    std::optional<double> reduced_chi_squared{};
    bool converged = true;
};

inline constexpr double kMinFittedAbsorption = 0.001, kMaxFittedAbsorption = 0.999;
/// Rays tell nothing of scattering that never happens, or always.
inline constexpr double kMinFittedScattering = 0.01, kMaxFittedScattering = 0.99;

BandFit fit_band(const BandFitProblem& problem);

}  // namespace earshot::propagation
