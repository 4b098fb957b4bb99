// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/coefficient_prior.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/simulator.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A metric of a pair in one band, as measured.
struct MeasuredMetric {
    std::size_t source = 0;    ///< index into Scene::sources
    std::size_t listener = 0;  ///< index into Scene::listeners
    std::size_t kind = 0;      ///< index into audio::kBandMetricKinds
    std::size_t band = 0;      ///< of CalibrationOptions::simulation
    double value = 0.0;        ///< in the metric's unit
    /// Standard error, > 0; see CalibrationOptions::default_error if there is none.
    std::optional<double> error{};

    friend bool operator==(const MeasuredMetric&, const MeasuredMetric&) = default;
};

struct CalibrationOptions {
    /// Paths, rays and bands; what is reported is chosen by the calibration.
    Options simulation{};
    double time = 0.0;  ///< seconds, of the scene's animation
    /// Standard error of measured values that have none, in just-noticeable differences, > 0.
    double default_error = 0.5;
    /// Standard deviation of the priors about what the scene says, in coefficient_spread()s, > 0.
    double prior_deviation = 1.0;
    /// Fit scattering as well as absorption.
    bool fit_scattering = false;
    /// Indices of materials of which nothing is known: kUnknownDeviation.
    std::vector<std::uint32_t> unknown_materials{};
    /// Indices of materials that keep their coefficients.
    std::vector<std::uint32_t> fixed_materials{};
    /// Residuals beyond so many standard errors count less (Huber's loss), > 0.
    double outlier_limit = 2.5;
    int max_simulations = 5;  ///< >= 1
};

/// A coefficient of a material in a band.
struct FittedCoefficient {
    CoefficientPrior prior{};
    bool is_fitted = false;  ///< fixed materials and bands without measurements are not
    double value = 0.0;
    double error = 0.0;  ///< standard error, data and prior together
    /// Of 95 %: 1.96 errors to both sides on the scale of spreads, within 0 ... 1.
    double lower = 0.0, upper = 0.0;
    /// Standard error of the data alone, without the prior; nothing where they do not tell it.
    std::optional<double> data_error{};
    /// The share of the prior's variance that the data have removed.
    double data_share = 0.0;
    bool is_at_bound = false;

    /// Whether the data alone tell the coefficient: twice as well as the prior does.
    bool is_identified() const noexcept {
        return is_fitted && data_error && 2.0 * *data_error <= prior.rate_at(prior.mean);
    }
};

/// Coefficients that the data of a band do not tell one by one; one alone if it is hardly heard.
struct UnidentifiedGroup {
    std::size_t band = 0;
    std::vector<std::uint32_t> materials{};   ///< whose absorption belongs to it, ascending
    std::vector<std::uint32_t> scattering{};  ///< likewise, whose scattering
    /// What the data do tell of absorption alone: the weighted mean of the coefficients, weights of
    /// sum 1. Empty if that is not known either, or if scattering belongs to the group.
    std::vector<double> weights{};
    double value = 0.0;  ///< of this mean
    double error = 0.0;  ///< its standard error
};

/// A measured value and the model's, before and after the fit.
struct CalibratedMetric {
    MeasuredMetric measured{};
    double error = 0.0;  ///< standard error of the measurement, in the metric's unit
    double just_noticeable_difference = 0.0;  ///< in the metric's unit
    /// Of the model, nothing where it has no such value: then it is left out of the fit.
    std::optional<double> before{}, after{};
    double model_error = 0.0;  ///< standard error of the model's value for the chance of its rays
    double weight = 0.0;       ///< 1; less for outliers; 0 if it is left out
};

struct CalibratedBand {
    std::size_t values = 0;  ///< measured values that were fitted
    /// Root mean square of model - measured in just-noticeable differences.
    double before = 0.0, after = 0.0;
    /// Sum of the squared weighted residuals over the degrees of freedom; nothing without any.
    std::optional<double> reduced_chi_squared{};
    bool converged = true;
};

struct CalibrationResult {
    std::vector<std::vector<FittedCoefficient>> absorption{};  ///< material, band
    std::vector<std::vector<FittedCoefficient>> scattering{};  ///< likewise; empty unless fitted
    std::vector<CalibratedMetric> metrics{};                   ///< as they were measured
    std::vector<CalibratedBand> bands{};
    std::vector<UnidentifiedGroup> groups{};  ///< by band, then by first coefficient
    int simulations = 0;
    bool converged = true;
    std::size_t rays = 0;  ///< per source, of each simulation
    Warnings warnings{};
};

/// The scattering that materials start from that scatter nothing: nobody set it.
inline constexpr double kUnknownScattering = 0.1;

/// Fits the absorption of the scene's materials, and their scattering if asked for, per band, to
/// measured metrics: the most probable coefficients under normal errors of the measurements and of
/// the rays, and normal priors about what the scene says (docs/calibrate.md). Of materials that
/// scatter nothing the scattering is not known. Simulates with the same random numbers until the
/// coefficients stay; between two simulations paths are recomputed exactly, late energy to first
/// order. Coefficients, errors and limits are rounded to 0.001, shares and weights to 0.01. Throws
/// Error if there is nothing to fit, an option, index or value is out of range, or this build is
/// without the solver (least_squares_available()). Reports the stages of Simulator::run() for each
/// simulation.
CalibrationResult calibrate_materials(const Scene& scene,
                                      std::span<const MeasuredMetric> measured,
                                      const CalibrationOptions& options = {},
                                      Executor& executor = Executor::serial(),
                                      Progress* progress = nullptr);

/// The materials of the scene with the coefficients of the result; a material that was not fitted
/// in any band stays as it is.
std::vector<Material> calibrated_materials(const Scene& scene,
                                           const CalibrationResult& result,
                                           const audio::Bands& bands);

}  // namespace earshot::propagation
