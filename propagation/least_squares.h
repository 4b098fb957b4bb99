// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Writes the residuals at `parameters` and, unless `jacobian` is empty, their derivatives,
/// row-major from residual to parameter. Residuals are in units of their standard deviations.
/// Values that are not finite refuse the step that led there. The parameters are within the bounds.
using ResidualFunction = std::function<void(
    std::span<const double> parameters, std::span<double> residuals, std::span<double> jacobian)>;

/// Residuals that are to be small. Prior knowledge of a parameter is a residual like any other:
/// (value - expected) / standard deviation.
struct LeastSquaresProblem {
    ResidualFunction evaluate{};
    std::size_t residual_count = 0;
    /// The first so many residuals are taken robustly, by Huber's loss; the rest (priors) squared.
    std::size_t robust_count = 0;
    std::vector<double> min_values{};  ///< of the parameters; empty: no bounds below
    std::vector<double> max_values{};  ///< empty: no bounds above
};

struct LeastSquaresOptions {
    int max_iterations = 200;  ///< steps tried, in all
    /// A step smaller than this, relative to the norm of the parameters, ends the search.
    double parameter_tolerance = 1e-9;
    /// So does a gradient smaller than this, of the sum of half squares by parameters that are
    /// scaled by the norms of their derivatives.
    double gradient_tolerance = 1e-10;
    /// Where Huber's loss (Huber 1964) turns from square to linear. With 1.345 an estimate from
    /// normal errors keeps 95 % of the efficiency of least squares.
    double huber_width = 1.345;
    /// Directions whose eigenvalue of the scaled normal matrix is below this share of the largest
    /// count as not determined by the residuals.
    double rank_tolerance = 1e-12;
};

/// What the residuals say of the parameters at the solution: the normal matrix J^T W J. W is 1 for
/// residuals whose square counts; for robust ones the number by which Huber's loss, with the
/// residuals as they are spread, lowers what each of them tells (Huber 1981, section 7.6), at
/// most 1. Bounds are not considered: a parameter at a bound has the spread that it would have
/// without.
struct ParameterCovariance {
    /// Row-major, of residuals with unit variance; the pseudo-inverse if the rank is deficient.
    std::vector<double> covariance{};
    /// Of each parameter; infinite if a direction that is not determined moves it.
    std::vector<double> standard_errors;
    /// Of the normal matrix with its diagonal scaled to 1, ascending, and the directions to them,
    /// one row each, in units in which each derivative column has the norm 1 (parameters without
    /// any effect: in their own units).
    std::vector<double> eigenvalues;
    std::vector<double> eigenvectors;
    std::size_t rank = 0;
    /// Changes of the parameters that the residuals do not tell apart from none, to first order:
    /// one row each, in the parameters' units, the largest component 1.
    std::vector<std::vector<double>> null_directions;
};

struct LeastSquaresSolution {
    std::vector<double> parameters;
    std::vector<double> residuals;       ///< at the solution
    std::vector<double> robust_weights;  ///< of the residuals, in (0, 1]
    std::vector<bool> at_bound;          ///< per parameter: held at a bound against the gradient
    bool converged = false;              ///< otherwise max_iterations were not enough
    int iterations = 0;
    double cost_before = 0.0;  ///< half the sum of squares (Huber: of losses) at the start
    double cost_after = 0.0;   ///< never more than cost_before
    ParameterCovariance information;
};

/// Whether this build holds the solver: Ceres' header ceres/tiny_solver.h was found.
bool least_squares_available() noexcept;

/// A local minimum of the sum of squares (of Huber's losses) within the bounds, from `start`, which
/// is moved into the bounds first. One thread; the same bits on every run. Throws Error if this
/// build is without the solver, or if the residuals at the start are not finite.
///
/// Levenberg and Marquardt's method (Madsen, Nielsen & Tingleff 2004) of Ceres' TinySolver, on the
/// parameters projected into the bounds (Kanzow, Yamashita & Fukushima 2004): what a step leads
/// beyond a bound stays at it until the gradient points inwards. Huber's loss by iterated
/// reweighting (Holland & Welsch 1977).
LeastSquaresSolution solve_least_squares(const LeastSquaresProblem& problem,
                                         std::span<const double> start,
                                         const LeastSquaresOptions& options = {});

}  // namespace earshot::propagation
