// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/band_fit.h"

#include "earshot/base/assert.h"
#include "earshot/propagation/internal/ray_covariance.h"
#include "earshot/propagation/least_squares.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace earshot::propagation {

namespace {

/// The factor L of a covariance L L^T, row-major, by Cholesky's method. A variance that rounding
/// leaves below a share of its own stays at that.
std::vector<double> cholesky_factor(std::vector<double> matrix, std::size_t count) {
    constexpr double kMinShare = 1e-6;
    for (std::size_t i = 0; i < count; ++i) {
        const double own = matrix[i * count + i];
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = matrix[i * count + j];
            for (std::size_t k = 0; k < j; ++k) {
                sum -= matrix[i * count + k] * matrix[j * count + k];
            }
            matrix[i * count + j] =
                i == j ? std::sqrt(std::max(sum, kMinShare * own)) : sum / matrix[j * count + j];
        }
    }
    return matrix;
}

/// Solves L x = b in place for elements that are `stride` apart.
void solve_lower(std::span<const double> factor, std::size_t count, double* b, std::size_t stride) {
    for (std::size_t i = 0; i < count; ++i) {
        double sum = b[i * stride];
        for (std::size_t k = 0; k < i; ++k) {
            sum -= factor[i * count + k] * b[k * stride];
        }
        b[i * stride] = sum / factor[i * count + i];
    }
}

/// Residuals that are independent and have unit variance: of the data, then of the priors.
/// Parameters tell by how many of its prior's deviations a coefficient is above the prior's mean.
class BandResiduals {
public:
    explicit BandResiduals(const BandFitProblem& problem) : problem_(problem) {
        for (std::size_t i = 0; i < problem.priors.size(); ++i) {
            if (problem.priors[i].deviation > 0.0) {
                parameters_.push_back(i);
            }
        }
        std::vector<std::vector<MetricVector>> deviations;
        for (std::size_t i = 0; i < problem.data.size(); ++i) {
            const std::size_t pair = problem.data[i].pair;
            if (!place_of_pair_.contains(pair)) {
                place_of_pair_.emplace(pair, pairs_.size());
                pairs_.push_back({.pair = pair,
                                  .simulated = problem.models[pair].evaluate(
                                      problem.band, problem.coefficients)});
                deviations.push_back(problem.models[pair].ray_deviations(problem.band));
            }
            if (simulated(i)) {
                data_.push_back(i);
            }
        }
        const RayCovariance of_rays(deviations);
        for (const std::size_t i : data_) {
            for (const std::size_t j : data_) {
                const BandDatum& a = problem.data[i];
                const BandDatum& b = problem.data[j];
                of_rays_.push_back(of_rays.covariance(
                    place_of_pair_.at(a.pair), a.kind, place_of_pair_.at(b.pair), b.kind));
            }
        }
        set_weights(std::vector<double>(data_.size(), 1.0));
    }

    const std::vector<std::size_t>& parameters() const { return parameters_; }
    /// Indices of the data of which the model has a value.
    const std::vector<std::size_t>& data() const { return data_; }
    std::size_t count() const { return data_.size() + parameters_.size(); }
    const CoefficientPrior& prior(std::size_t parameter) const {
        return problem_.priors[parameters_[parameter]];
    }
    double min_value(std::size_t parameter) const {
        return problem_.min_values[parameters_[parameter]];
    }
    double max_value(std::size_t parameter) const {
        return problem_.max_values[parameters_[parameter]];
    }
    /// The model's value of any datum, as simulated.
    const std::optional<double>& simulated(std::size_t datum) const {
        const BandDatum& at = problem_.data[datum];
        return pairs_[place_of_pair_.at(at.pair)].simulated.values[at.kind];
    }
    /// Variance of the model's value of the k-th of the data for the chance of the rays.
    double ray_variance(std::size_t k) const { return of_rays_[k * data_.size() + k]; }

    /// Data of less weight have so much larger variances.
    void set_weights(std::span<const double> weights) {
        std::vector<double> covariance = of_rays_;
        for (std::size_t k = 0; k < data_.size(); ++k) {
            const double error = problem_.data[data_[k]].error;
            covariance[k * data_.size() + k] += error * error / weights[k];
        }
        factor_ = cholesky_factor(std::move(covariance), data_.size());
    }

    std::vector<double> coefficients(std::span<const double> z) const {
        std::vector<double> result = problem_.coefficients;
        for (std::size_t k = 0; k < parameters_.size(); ++k) {
            result[parameters_[k]] =
                std::clamp(prior(k).value_at(z[k]), min_value(k), max_value(k));
        }
        return result;
    }

    /// Model - measured of the data, in their units.
    std::vector<double> differences(std::span<const double> z) const {
        std::vector<double> result(count());
        read_pairs(coefficients(z), result, {});
        result.resize(data_.size());
        return result;
    }

    void evaluate(std::span<const double> z,
                  std::span<double> residuals,
                  std::span<double> jacobian) const {
        const std::size_t columns = parameters_.size();
        std::fill(jacobian.begin(), jacobian.end(), 0.0);
        read_pairs(coefficients(z), residuals, jacobian);
        solve_lower(factor_, data_.size(), residuals.data(), 1);
        for (std::size_t p = 0; p < columns && !jacobian.empty(); ++p) {
            solve_lower(factor_, data_.size(), jacobian.data() + p, columns);
        }
        for (std::size_t p = 0; p < columns; ++p) {
            residuals[data_.size() + p] = z[p];
            if (!jacobian.empty()) {
                jacobian[(data_.size() + p) * columns + p] = 1.0;
            }
        }
    }

private:
    struct Pair {
        std::size_t pair = 0;
        ModelledMetrics simulated{};
    };

    void read_pairs(std::span<const double> at,
                    std::span<double> residuals,
                    std::span<double> jacobian) const {
        std::vector<ModelledMetrics> modelled;
        for (const Pair& pair : pairs_) {
            modelled.push_back(problem_.models[pair.pair].evaluate(problem_.band, at));
        }
        for (std::size_t k = 0; k < data_.size(); ++k) {
            const BandDatum& datum = problem_.data[data_[k]];
            const ModelledMetrics& model = modelled[place_of_pair_.at(datum.pair)];
            // A value that is lost on the way to other coefficients pulls nowhere.
            residuals[k] = model.values[datum.kind].value_or(*simulated(data_[k])) - datum.value;
            for (std::size_t p = 0; p < parameters_.size() && !jacobian.empty(); ++p) {
                const std::size_t i = parameters_[p];
                jacobian[k * parameters_.size() + p] =
                    model.derivatives[i][datum.kind] * prior(p).rate_at(at[i]);
            }
        }
    }

    const BandFitProblem& problem_;
    std::vector<std::size_t> parameters_;  // indices of coefficients
    std::vector<std::size_t> data_;        // indices
    std::vector<Pair> pairs_;
    std::map<std::size_t, std::size_t> place_of_pair_;  // in pairs_
    std::vector<double> of_rays_;                       // covariance of the data, row-major
    std::vector<double> factor_;                        // Cholesky's, of the whole covariance
};

LeastSquaresProblem solver_problem(const BandResiduals& residuals) {
    LeastSquaresProblem problem = {
        .evaluate = [&residuals](
                        std::span<const double> z,
                        std::span<double> values,
                        std::span<double> jacobian) { residuals.evaluate(z, values, jacobian); },
        .residual_count = residuals.count()};
    for (std::size_t k = 0; k < residuals.parameters().size(); ++k) {
        const CoefficientPrior& prior = residuals.prior(k);
        problem.min_values.push_back(prior.deviations_of(residuals.min_value(k)));
        problem.max_values.push_back(prior.deviations_of(residuals.max_value(k)));
    }
    return problem;
}

/// Huber's weights (Huber 1981, section 7.8), of differences over their standard errors. They apply
/// to the data themselves, not to the independent residuals, of which an outlier would bend
/// several.
std::vector<double> huber_weights(const BandFitProblem& problem,
                                  const BandResiduals& residuals,
                                  std::span<const double> z) {
    std::vector<double> weights = residuals.differences(z);
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const double error = problem.data[residuals.data()[k]].error;
        const double size =
            std::abs(weights[k]) / std::sqrt(error * error + residuals.ray_variance(k));
        weights[k] = size > problem.outlier_limit ? problem.outlier_limit / size : 1.0;
    }
    return weights;
}

/// Solves with weights that follow the differences.
LeastSquaresSolution solve(const BandFitProblem& problem,
                           BandResiduals& residuals,
                           std::vector<double>& weights) {
    // Far below the error of any coefficient: the next simulation begins where this fit ends. Decay
    // times change in small steps, so that a search for the very minimum would not end.
    constexpr double kTolerance = 1e-3, kWeightTolerance = 0.05;
    constexpr int kMaxIterations = 30, kMaxWeightings = 5;
    std::vector<double> start;
    for (std::size_t k = 0; k < residuals.parameters().size(); ++k) {
        start.push_back(
            residuals.prior(k).deviations_of(problem.coefficients[residuals.parameters()[k]]));
    }
    for (int weighting = 1;; ++weighting) {
        LeastSquaresSolution solution = solve_least_squares(
            solver_problem(residuals),
            start,
            {.max_iterations = kMaxIterations, .parameter_tolerance = kTolerance});
        std::vector<double> next = huber_weights(problem, residuals, solution.parameters);
        double change = 0.0;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            change = std::max(change, std::abs(next[k] - weights[k]));
        }
        if (change <= kWeightTolerance || weighting == kMaxWeightings) {
            return solution;
        }
        weights = std::move(next);
        residuals.set_weights(weights);
        start = std::move(solution.parameters);
    }
}

/// What is left over of the data where the fit explains all but their errors is 1. Errors that are
/// too small for what is left over count as so much larger.
void read_spread(const LeastSquaresSolution& solution, std::size_t data_count, BandFit& fit) {
    const std::size_t count = fit.parameters.size();
    const std::vector<double>& covariance = solution.information.covariance;
    fit.identifiability.emplace(covariance, count);
    double sum = 0.0;
    for (std::size_t k = 0; k < data_count; ++k) {
        sum += solution.residuals[k] * solution.residuals[k];
    }
    const double freedom = static_cast<double>(data_count) - fit.identifiability->told_parameters();
    if (freedom < 1.0) {
        return;
    }
    fit.reduced_chi_squared = sum / freedom;
    if (*fit.reduced_chi_squared > 1.0) {
        fit.identifiability.emplace(covariance, count, *fit.reduced_chi_squared);
    }
}

}  // namespace

BandFit fit_band(const BandFitProblem& problem) {
    BandResiduals residuals(problem);
    BandFit fit = {.parameters = residuals.parameters(),
                   .coefficients = problem.coefficients,
                   .model_errors = std::vector<double>(problem.data.size(), 0.0),
                   .weights = std::vector<double>(problem.data.size(), 0.0)};
    for (std::size_t i = 0; i < problem.data.size(); ++i) {
        fit.values.push_back(residuals.simulated(i));
    }
    std::vector<double> weights(residuals.data().size(), 1.0);
    if (!weights.empty() && !fit.parameters.empty()) {
        const LeastSquaresSolution solution = solve(problem, residuals, weights);
        fit.coefficients = residuals.coefficients(solution.parameters);
        fit.is_at_bound = solution.at_bound;
        fit.converged = solution.converged;
        read_spread(solution, weights.size(), fit);
    }
    for (std::size_t k = 0; k < weights.size(); ++k) {
        fit.weights[residuals.data()[k]] = weights[k];
        fit.model_errors[residuals.data()[k]] = std::sqrt(residuals.ray_variance(k));
    }
    return fit;
}

}  // namespace earshot::propagation
