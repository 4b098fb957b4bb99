// SPDX-License-Identifier: MIT
#include "earshot/propagation/least_squares.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

// A header that needs Eigen alone: no library of Ceres is linked, and with it none of SuiteSparse.
#include <Eigen/Eigenvalues>
#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::propagation {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The blocks of Eigen's products follow the sizes of the caches, and the order of sums the blocks:
/// fixed, so that the bits are the same on every processor.
void fix_order_of_sums() {
    [[maybe_unused]] static const bool is_fixed = [] {
        Eigen::setCpuCacheSizes(32 * 1024, 256 * 1024, 2 * 1024 * 1024);
        return true;
    }();
}

double squared(double value) noexcept {
    return value * value;
}

/// The weighted problem in the form that TinySolver asks for, on parameters of any value.
class ProjectedResiduals {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

    ProjectedResiduals(const LeastSquaresProblem& problem, std::size_t parameter_count)
        : problem_(problem),
          lows_(problem.min_values),
          highs_(problem.max_values),
          root_weights_(problem.residual_count, 1.0),
          is_held_(parameter_count, false) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        EARSHOT_ASSERT(lows_.empty() || lows_.size() == parameter_count);
        EARSHOT_ASSERT(highs_.empty() || highs_.size() == parameter_count);
        lows_.resize(parameter_count, -kInfinity);
        highs_.resize(parameter_count, kInfinity);
    }

    int NumResiduals() const { return static_cast<int>(root_weights_.size()); }
    int NumParameters() const { return static_cast<int>(is_held_.size()); }

    double projected(std::size_t parameter, double value) const noexcept {
        return std::min(std::max(value, lows_[parameter]), highs_[parameter]);
    }

    /// The derivatives are column-major, as Eigen's are; null if not asked for. Beyond a bound the
    /// residuals do not change.
    bool operator()(const double* parameters, double* residuals, double* jacobian) const {
        const std::size_t columns = is_held_.size(), rows = root_weights_.size();
        std::vector<double> inside(columns);
        for (std::size_t k = 0; k < columns; ++k) {
            inside[k] = projected(k, parameters[k]);
        }
        std::vector<double> derivatives(jacobian != nullptr ? rows * columns : 0);
        problem_.evaluate(inside, {residuals, rows}, derivatives);
        for (std::size_t i = 0; i < rows; ++i) {
            residuals[i] *= root_weights_[i];
        }
        for (std::size_t k = 0; k < columns && jacobian != nullptr; ++k) {
            // Not <, so that a value that is not finite moves nothing.
            const bool is_free = !is_held_[k] && inside[k] == parameters[k];
            for (std::size_t i = 0; i < rows; ++i) {
                jacobian[k * rows + i] =
                    is_free ? root_weights_[i] * derivatives[i * columns + k] : 0.0;
            }
        }
        return true;
    }

    void set_weights(std::span<const double> weights) {
        for (std::size_t i = 0; i < weights.size(); ++i) {
            root_weights_[i] = std::sqrt(weights[i]);
        }
    }

    /// Holds the parameters at a bound against which the gradient of the cost presses them.
    void hold(std::span<const double> parameters, const Vector& gradient) {
        for (std::size_t k = 0; k < is_held_.size(); ++k) {
            const double slope = gradient(static_cast<Eigen::Index>(k));
            is_held_[k] = (parameters[k] <= lows_[k] && slope > 0.0) ||
                          (parameters[k] >= highs_[k] && slope < 0.0);
        }
    }
    const std::vector<bool>& held() const noexcept { return is_held_; }

private:
    const LeastSquaresProblem& problem_;
    std::vector<double> lows_, highs_;
    std::vector<double> root_weights_;
    std::vector<bool> is_held_;
};

/// Residuals without weights and their derivatives at a point.
struct Linearization {
    std::vector<double> residuals;
    RowMajorMatrix jacobian;
};

Linearization linearize(const LeastSquaresProblem& problem, std::span<const double> parameters) {
    Linearization at{.residuals = std::vector<double>(problem.residual_count), .jacobian = {}};
    at.jacobian.setZero(static_cast<Eigen::Index>(problem.residual_count),
                        static_cast<Eigen::Index>(parameters.size()));
    problem.evaluate(
        parameters, at.residuals, {at.jacobian.data(), problem.residual_count * parameters.size()});
    return at;
}

bool is_robust(const LeastSquaresProblem& problem,
               const LeastSquaresOptions& options,
               const std::vector<double>& residuals,
               std::size_t i) noexcept {
    return i < problem.robust_count && std::abs(residuals[i]) > options.huber_width;
}

/// Huber's weights: the loss beyond the width grows as the residual does, not as its square.
std::vector<double> weights_of(const LeastSquaresProblem& problem,
                               const LeastSquaresOptions& options,
                               const std::vector<double>& residuals) {
    std::vector<double> weights(residuals.size(), 1.0);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (is_robust(problem, options, residuals, i)) {
            weights[i] = options.huber_width / std::abs(residuals[i]);
        }
    }
    return weights;
}

double cost_of(const LeastSquaresProblem& problem,
               const LeastSquaresOptions& options,
               const std::vector<double>& residuals) noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        sum += is_robust(problem, options, residuals, i)
                   ? options.huber_width * (std::abs(residuals[i]) - options.huber_width / 2.0)
                   : squared(residuals[i]) / 2.0;
    }
    return sum;
}

Vector gradient_of(const Linearization& at, const std::vector<double>& weights) {
    Vector weighted(static_cast<Eigen::Index>(weights.size()));
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weighted(static_cast<Eigen::Index>(i)) = weights[i] * at.residuals[i];
    }
    return at.jacobian.transpose() * weighted;
}

bool is_small_step(std::span<const double> from, std::span<const double> to, double tolerance) {
    double step = 0.0, norm = 0.0;
    for (std::size_t k = 0; k < from.size(); ++k) {
        step += squared(to[k] - from[k]);
        norm += squared(to[k]);
    }
    return std::sqrt(step) <= tolerance * (std::sqrt(norm) + tolerance);
}

/// Scales and eigenvectors of the normal matrix, from which all of the covariance follows.
struct ScaledEigenvectors {
    Vector scales;  // of the parameters: the inverse norms of the derivatives' columns
    Eigen::SelfAdjointEigenSolver<Matrix> solver;
};

ScaledEigenvectors eigenvectors_of(const RowMajorMatrix& jacobian,
                                   const std::vector<double>& weights) {
    Matrix weighted = jacobian;
    for (Eigen::Index i = 0; i < weighted.rows(); ++i) {
        weighted.row(i) *= std::sqrt(weights[static_cast<std::size_t>(i)]);
    }
    ScaledEigenvectors result{.scales = Vector::Ones(weighted.cols()), .solver = {}};
    for (Eigen::Index k = 0; k < weighted.cols(); ++k) {
        const double norm = weighted.col(k).norm();
        result.scales(k) = norm > 0.0 ? 1.0 / norm : 1.0;
        weighted.col(k) *= result.scales(k);
    }
    result.solver.compute(weighted.transpose() * weighted);
    return result;
}

/// Parameters that a null direction moves by more than its own rounding cannot be told.
constexpr double kMovedShare = 1e-6;

ParameterCovariance covariance_of(const ScaledEigenvectors& scaled, double rank_tolerance) {
    const Vector& values = scaled.solver.eigenvalues();
    const Matrix& vectors = scaled.solver.eigenvectors();
    const Eigen::Index count = values.size();
    const double floor = count > 0 ? rank_tolerance * values(count - 1) : 0.0;
    ParameterCovariance result;
    Matrix covariance = Matrix::Zero(count, count);
    std::vector<bool> is_moved(static_cast<std::size_t>(count), false);
    for (Eigen::Index e = 0; e < count; ++e) {
        const Vector direction = scaled.scales.asDiagonal() * vectors.col(e);
        result.eigenvalues.push_back(values(e));
        const Vector vector = vectors.col(e);
        result.eigenvectors.insert(result.eigenvectors.end(), vector.begin(), vector.end());
        if (values(e) > floor) {
            ++result.rank;
            covariance += direction * direction.transpose() / values(e);
            continue;
        }
        Eigen::Index largest = 0;
        direction.cwiseAbs().maxCoeff(&largest);
        const Vector unit = direction / direction(largest);
        result.null_directions.emplace_back(unit.begin(), unit.end());
        for (Eigen::Index k = 0; k < count; ++k) {
            if (std::abs(vectors(k, e)) > kMovedShare) {
                is_moved[static_cast<std::size_t>(k)] = true;
            }
        }
    }
    result.covariance.assign(covariance.data(), covariance.data() + covariance.size());
    for (Eigen::Index k = 0; k < count; ++k) {
        result.standard_errors.push_back(is_moved[static_cast<std::size_t>(k)]
                                             ? std::numeric_limits<double>::infinity()
                                             : std::sqrt(covariance(k, k)));
    }
    return result;
}

/// What a robust residual tells, as a share of what it would tell by its square: the inverse of
/// Huber's asymptotic variance, (mean of psi')^2 over mean of psi^2, with the parameters that the
/// residuals were spent on taken off. The residuals' variance is known, so it is at most 1.
double robust_share(const LeastSquaresProblem& problem,
                    const LeastSquaresOptions& options,
                    const Linearization& at,
                    const std::vector<double>& weights) {
    const ParameterCovariance information =
        covariance_of(eigenvectors_of(at.jacobian, weights), options.rank_tolerance);
    const auto columns = at.jacobian.cols();
    const Eigen::Map<const Matrix> covariance(information.covariance.data(), columns, columns);
    double inner = 0.0, squares = 0.0, spent = 0.0;
    for (std::size_t i = 0; i < problem.robust_count; ++i) {
        const auto row = at.jacobian.row(static_cast<Eigen::Index>(i));
        spent += weights[i] * row.dot(row * covariance);
        inner += is_robust(problem, options, at.residuals, i) ? 0.0 : 1.0;
        squares += squared(weights[i] * at.residuals[i]);
    }
    const auto count = static_cast<double>(problem.robust_count);
    const double freedom = count - spent;
    if (inner == 0.0 || freedom <= 0.0 || squares == 0.0) {
        return 1.0;
    }
    return std::min(1.0, squared(inner / count) * freedom / squares);
}

/// The weights of the residuals in the normal matrix of ParameterCovariance.
std::vector<double> information_weights(const LeastSquaresProblem& problem,
                                        const LeastSquaresOptions& options,
                                        const Linearization& at,
                                        const std::vector<double>& weights) {
    std::vector<double> result(weights.size(), 1.0);
    if (problem.robust_count > 0) {
        std::fill_n(
            result.begin(), problem.robust_count, robust_share(problem, options, at, weights));
    }
    return result;
}

/// One run of the solver with fixed weights and held parameters, from the solution's parameters.
/// Returns whether it came to an end before its steps did.
bool run_solver(const ProjectedResiduals& residuals,
                const LeastSquaresOptions& options,
                int max_iterations,
                LeastSquaresSolution& solution) {
    ceres::TinySolver<ProjectedResiduals> solver;
    // TinySolver counts the first evaluation, and compares costs absolutely: what ends the search
    // are steps and gradients.
    solver.options.max_num_iterations = max_iterations + 1;
    solver.options.gradient_tolerance = options.gradient_tolerance;
    solver.options.parameter_tolerance = options.parameter_tolerance;
    solver.options.function_tolerance = 0.0;
    solver.options.cost_threshold = 0.0;
    Vector at = Eigen::Map<const Vector>(solution.parameters.data(),
                                         static_cast<Eigen::Index>(solution.parameters.size()));
    solver.Solve(residuals, &at);
    solution.iterations += std::min(solver.summary.iterations, max_iterations);
    for (std::size_t k = 0; k < solution.parameters.size(); ++k) {
        solution.parameters[k] = residuals.projected(k, at(static_cast<Eigen::Index>(k)));
    }
    return solver.summary.status != ceres::TinySolver<ProjectedResiduals>::HIT_MAX_ITERATIONS;
}

void check_finite(const std::vector<double>& residuals) {
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (!std::isfinite(residuals[i])) {
            throw Error("least squares",
                        "residual " + std::to_string(i) + " is not finite at the start");
        }
    }
}

}  // namespace

bool least_squares_available() noexcept {
    return true;
}

LeastSquaresSolution solve_least_squares(const LeastSquaresProblem& problem,
                                         std::span<const double> start,
                                         const LeastSquaresOptions& options) {
    fix_order_of_sums();
    EARSHOT_ASSERT(problem.robust_count <= problem.residual_count);
    // With weights that follow the residuals a run need not be exact before the next one.
    constexpr int kMaxStepsOfWeights = 10;
    ProjectedResiduals residuals(problem, start.size());
    LeastSquaresSolution solution;
    for (std::size_t k = 0; k < start.size(); ++k) {
        solution.parameters.push_back(residuals.projected(k, start[k]));
    }
    Linearization at = linearize(problem, solution.parameters);
    check_finite(at.residuals);
    solution.cost_before = cost_of(problem, options, at.residuals);
    bool is_at_end = start.empty() || problem.residual_count == 0;
    while (true) {
        const std::vector<double> weights = weights_of(problem, options, at.residuals);
        residuals.set_weights(weights);
        residuals.hold(solution.parameters, gradient_of(at, weights));
        if (is_at_end || solution.iterations >= options.max_iterations) {
            break;
        }
        const std::vector<double> before = solution.parameters;
        const int rest = options.max_iterations - solution.iterations;
        const bool is_finished =
            run_solver(residuals,
                       options,
                       problem.robust_count > 0 ? std::min(rest, kMaxStepsOfWeights) : rest,
                       solution);
        // At the end neither new weights nor parameters that are released move anything.
        is_at_end =
            is_finished && is_small_step(before, solution.parameters, options.parameter_tolerance);
        at = linearize(problem, solution.parameters);
    }
    solution.converged = is_at_end;
    solution.cost_after = cost_of(problem, options, at.residuals);
    solution.robust_weights = weights_of(problem, options, at.residuals);
    solution.at_bound = residuals.held();
    solution.information = covariance_of(
        eigenvectors_of(at.jacobian,
                        information_weights(problem, options, at, solution.robust_weights)),
        options.rank_tolerance);
    solution.residuals = std::move(at.residuals);
    return solution;
}

}  // namespace earshot::propagation
