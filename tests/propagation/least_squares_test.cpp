// SPDX-License-Identifier: MIT
// The solver against minima that are known from formulas, or found by bisection.
#include "earshot/propagation/least_squares.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include "support/random_normal.h"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using test::random_normal;

class LeastSquares : public testing::Test {
protected:
    void SetUp() override {
        if (!least_squares_available()) {
            GTEST_SKIP() << "built without Ceres' headers";
        }
    }
};

/// Rosenbrock's valley; its minimum is 0 at (1, 1).
LeastSquaresProblem rosenbrock() {
    return {.evaluate =
                [](std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
                    r[0] = 10.0 * (x[1] - x[0] * x[0]);
                    r[1] = 1.0 - x[0];
                    if (!jacobian.empty()) {
                        jacobian[0] = -20.0 * x[0];
                        jacobian[1] = 10.0;
                        jacobian[2] = -1.0;
                        jacobian[3] = 0.0;
                    }
                },
            .residual_count = 2};
}

/// r = A x - b, A row-major.
LeastSquaresProblem linear(std::vector<double> a, std::vector<double> b) {
    const std::size_t rows = b.size();
    return {.evaluate =
                [a = std::move(a), b = std::move(b)](
                    std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
                    for (std::size_t i = 0; i < r.size(); ++i) {
                        r[i] = -b[i];
                        for (std::size_t k = 0; k < x.size(); ++k) {
                            r[i] += a[i * x.size() + k] * x[k];
                        }
                    }
                    std::copy(a.begin(), jacobian.empty() ? a.begin() : a.end(), jacobian.begin());
                },
            .residual_count = rows};
}

/// Where an increasing function is zero.
template <typename Function>
double zero_of(const Function& function, double low, double high) {
    for (int i = 0; i < 200; ++i) {
        const double middle = (low + high) / 2.0;
        (function(middle) < 0.0 ? low : high) = middle;
    }
    return low;
}

TEST_F(LeastSquares, FollowsRosenbrocksValleyToItsEnd) {
    const std::vector<double> start = {-1.2, 1.0};
    const LeastSquaresSolution solution = solve_least_squares(rosenbrock(), start);
    EXPECT_TRUE(solution.converged);
    EXPECT_NEAR(solution.cost_before, (4.4 * 4.4 + 2.2 * 2.2) / 2.0, 1e-9);
    EXPECT_LT(solution.cost_after, 1e-16);
    // Ten times the length of the last step.
    EXPECT_NEAR(solution.parameters[0], 1.0, 1e-8);
    EXPECT_NEAR(solution.parameters[1], 1.0, 1e-8);
    EXPECT_GT(solution.iterations, 5);
    EXPECT_LT(solution.iterations, 100);
}

TEST_F(LeastSquares, SaysWhenItsStepsAreUsedUp) {
    const std::vector<double> start = {-1.2, 1.0};
    const LeastSquaresSolution solution =
        solve_least_squares(rosenbrock(), start, {.max_iterations = 4});
    EXPECT_FALSE(solution.converged);
    EXPECT_EQ(solution.iterations, 4);
    EXPECT_LE(solution.cost_after, solution.cost_before);
}

TEST_F(LeastSquares, StaysWithinBoundsAlongAValley) {
    LeastSquaresProblem problem = rosenbrock();
    problem.max_values = {0.5, 10.0};
    const std::vector<double> start = {-1.2, 1.0};
    LeastSquaresSolution solution = solve_least_squares(problem, start);
    EXPECT_TRUE(solution.converged);
    EXPECT_EQ(solution.parameters[0], 0.5);
    EXPECT_NEAR(solution.parameters[1], 0.25, 1e-9);
    EXPECT_EQ(solution.at_bound, (std::vector<bool>{true, false}));

    // With y <= 0.5 what remains is a function of x alone, whose derivative is zero once for x > 0.
    problem.max_values = {10.0, 0.5};
    const auto derivative = [](double x) { return -200.0 * x * (0.5 - x * x) - (1.0 - x); };
    const double expected = zero_of(derivative, 0.5, 2.0);
    const std::vector<double> right = {1.5, -3.0};
    solution = solve_least_squares(problem, right);
    EXPECT_TRUE(solution.converged);
    EXPECT_NEAR(solution.parameters[0], expected, 1e-8);
    EXPECT_EQ(solution.parameters[1], 0.5);
    EXPECT_EQ(solution.at_bound, (std::vector<bool>{false, true}));
}

/// (x + y - 3)^2 + (y + 1)^2 with y >= 0: y is 0 and x is 3. Without bounds x would be 4.
TEST_F(LeastSquares, MovesTheFreeParametersToTheMinimumOnTheBound) {
    LeastSquaresProblem problem = linear({1.0, 1.0, 0.0, 1.0}, {3.0, -1.0});
    problem.min_values = {-100.0, 0.0};
    for (const std::vector<double>& start :
         {std::vector<double>{0.0, 0.0}, {50.0, 70.0}, {-3.0, -5.0}}) {
        const LeastSquaresSolution solution = solve_least_squares(problem, start);
        EXPECT_TRUE(solution.converged);
        EXPECT_NEAR(solution.parameters[0], 3.0, 1e-8);
        EXPECT_EQ(solution.parameters[1], 0.0);
        EXPECT_EQ(solution.at_bound, (std::vector<bool>{false, true}));
        EXPECT_NEAR(solution.cost_after, 0.5, 1e-12);
    }
}

TEST_F(LeastSquares, LeavesABoundThatDoesNotBind) {
    LeastSquaresProblem problem = rosenbrock();
    problem.min_values = {-2.0, 0.0};
    problem.max_values = {2.0, 2.0};
    for (const std::vector<double>& start :
         {std::vector<double>{-2.0, 0.0}, {2.0, 0.0}, {-2.0, 2.0}, {7.0, 9.0}}) {
        const LeastSquaresSolution solution = solve_least_squares(problem, start);
        EXPECT_TRUE(solution.converged);
        EXPECT_NEAR(solution.parameters[0], 1.0, 1e-8);
        EXPECT_NEAR(solution.parameters[1], 1.0, 1e-8);
        EXPECT_EQ(solution.at_bound, (std::vector<bool>{false, false}));
    }
}

/// A line through points: the textbook's formulas for its variances.
TEST_F(LeastSquares, GivesTheCovarianceOfARegressionLine) {
    constexpr double kDeviation = 0.2;
    const std::vector<double> abscissae = {-1.0, 0.5, 2.0, 2.5, 4.0, 7.0};
    const std::vector<double> ordinates = {0.3, 0.9, 2.2, 2.1, 3.7, 6.0};
    std::vector<double> a, b;
    double sum = 0.0, squares = 0.0, mixed = 0.0, ordinate_sum = 0.0;
    const auto count = static_cast<double>(abscissae.size());
    for (std::size_t i = 0; i < abscissae.size(); ++i) {
        a.insert(a.end(), {1.0 / kDeviation, abscissae[i] / kDeviation});
        b.push_back(ordinates[i] / kDeviation);
        sum += abscissae[i];
        squares += abscissae[i] * abscissae[i];
        ordinate_sum += ordinates[i];
        mixed += abscissae[i] * ordinates[i];
    }
    const double mean = sum / count, spread = squares - sum * mean;
    const double slope = (mixed - mean * ordinate_sum) / spread;
    const double variance = kDeviation * kDeviation;
    const std::vector<double> start = {5.0, -5.0};
    const LeastSquaresSolution solution = solve_least_squares(linear(a, b), start);
    EXPECT_NEAR(solution.parameters[1], slope, 1e-10);
    EXPECT_NEAR(solution.parameters[0], ordinate_sum / count - slope * mean, 1e-10);
    const ParameterCovariance& information = solution.information;
    EXPECT_EQ(information.rank, 2U);
    EXPECT_TRUE(information.null_directions.empty());
    EXPECT_NEAR(information.covariance[0], variance * (1.0 / count + mean * mean / spread), 1e-14);
    EXPECT_NEAR(information.covariance[1], -variance * mean / spread, 1e-14);
    EXPECT_EQ(information.covariance[1], information.covariance[2]);
    EXPECT_NEAR(information.covariance[3], variance / spread, 1e-14);
    EXPECT_NEAR(information.standard_errors[1], std::sqrt(variance / spread), 1e-12);
}

/// Only a + 2 b counts, c is without effect, d is determined.
TEST_F(LeastSquares, NamesWhatTheResidualsDoNotTell) {
    const std::vector<double> start = {0.0, 0.0, 4.0, 0.0};
    const LeastSquaresSolution solution = solve_least_squares(
        linear({1.0, 2.0, 0.0, 0.0, 2.0, 4.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3.0}, {1.0, 2.5, 1.0}),
        start);
    const ParameterCovariance& information = solution.information;
    EXPECT_TRUE(solution.converged);
    EXPECT_EQ(information.rank, 2U);
    EXPECT_EQ(solution.parameters[2], 4.0);
    ASSERT_EQ(information.null_directions.size(), 2U);
    for (const std::vector<double>& direction : information.null_directions) {
        EXPECT_NEAR(direction[0] + 2.0 * direction[1], 0.0, 1e-9);
        EXPECT_NEAR(direction[3], 0.0, 1e-9);
        double largest = 0.0;
        for (const double component : direction) {
            largest = std::max(largest, std::abs(component));
        }
        EXPECT_EQ(largest, 1.0);
    }
    EXPECT_TRUE(std::isinf(information.standard_errors[0]));
    EXPECT_TRUE(std::isinf(information.standard_errors[1]));
    EXPECT_TRUE(std::isinf(information.standard_errors[2]));
    EXPECT_TRUE(std::isfinite(information.standard_errors[3]));
}

/// The location of values of which some are far off: Huber's estimate is where the clipped
/// residuals sum to zero.
TEST_F(LeastSquares, TakesOutliersAsHuberDoes) {
    constexpr double kWidth = 1.345;
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 40; ++i) {
        values.push_back(3.0 + random_normal(7, 1, i));
    }
    values.insert(values.end(), {50.0, 80.0, -12.0, 900.0});
    LeastSquaresProblem problem = linear(std::vector<double>(values.size(), 1.0), values);
    problem.robust_count = values.size();
    const double expected = zero_of(
        [&](double location) {
            double sum = 0.0;
            for (const double value : values) {
                sum += std::clamp(location - value, -kWidth, kWidth);
            }
            return sum;
        },
        -10.0,
        10.0);
    const std::vector<double> start = {400.0};
    const LeastSquaresSolution solution = solve_least_squares(problem, start);
    EXPECT_TRUE(solution.converged);
    EXPECT_NEAR(solution.parameters[0], expected, 1e-7);
    EXPECT_LT(solution.robust_weights.back(), 0.01);
    double cost = 0.0;
    for (const double value : values) {
        const double off = std::abs(value - expected);
        cost += off <= kWidth ? off * off / 2.0 : kWidth * (off - kWidth / 2.0);
    }
    EXPECT_NEAR(solution.cost_after, cost, 1e-9);
}

/// The standard error of a location from values with two kinds of errors, against the spread of the
/// estimates themselves.
TEST_F(LeastSquares, TellsTheSpreadOfARobustEstimate) {
    constexpr std::size_t kValues = 60, kSeeds = 400;
    for (const double outlying : {0.0, 0.3}) {
        double squares = 0.0, errors = 0.0;
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            std::vector<double> values;
            for (std::uint64_t i = 0; i < kValues; ++i) {
                const double deviation = random(seed, 1, i) < outlying ? 10.0 : 1.0;
                values.push_back(deviation * random_normal(seed, 2, i));
            }
            LeastSquaresProblem problem = linear(std::vector<double>(kValues, 1.0), values);
            problem.robust_count = kValues;
            const std::vector<double> start = {0.0};
            const LeastSquaresSolution solution = solve_least_squares(problem, start);
            squares += solution.parameters[0] * solution.parameters[0];
            errors += solution.information.standard_errors[0];
        }
        const double spread = std::sqrt(squares / static_cast<double>(kSeeds));
        // 400 estimates tell their spread to 3.5 %.
        EXPECT_NEAR(errors / static_cast<double>(kSeeds) / spread, 1.0, 0.1) << outlying;
    }
}

/// A prior stands after the robust residuals and keeps its square.
TEST_F(LeastSquares, TakesPriorsAsTheyAre) {
    LeastSquaresProblem problem = linear({1.0, 10.0}, {100.0, 0.0});
    problem.robust_count = 1;
    const std::vector<double> start = {0.0};
    const LeastSquaresSolution solution = solve_least_squares(problem, start);
    // The datum pulls with the force 1.345, the prior with 100 x.
    EXPECT_NEAR(solution.parameters[0], 0.01345, 1e-9);
    EXPECT_EQ(solution.robust_weights[1], 1.0);
}

TEST_F(LeastSquares, RefusesStepsToWhereNothingIsDefined) {
    const LeastSquaresProblem problem = {
        .evaluate =
            [](std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
                r[0] = std::log(x[0]);  // not a number below zero, where a first step leads
                if (!jacobian.empty()) {
                    jacobian[0] = 1.0 / x[0];
                }
            },
        .residual_count = 1};
    const std::vector<double> start = {20.0};
    const LeastSquaresSolution solution = solve_least_squares(problem, start);
    EXPECT_TRUE(solution.converged);
    EXPECT_NEAR(solution.parameters[0], 1.0, 1e-9);
    const std::vector<double> nowhere = {-1.0};
    EXPECT_THROW(solve_least_squares(problem, nowhere), Error);
}

/// A hundred seeded bounded linear problems: at the end the gradient presses against the bounds
/// alone.
TEST_F(LeastSquares, MeetsTheConditionsOfAMinimumWithinBounds) {
    constexpr std::size_t kRows = 12, kColumns = 5;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        std::vector<double> a, b, start;
        for (std::uint64_t i = 0; i < kRows * kColumns; ++i) {
            a.push_back(random_normal(seed, 1, i));
        }
        for (std::uint64_t i = 0; i < kRows; ++i) {
            b.push_back(3.0 * random_normal(seed, 2, i));
        }
        for (std::uint64_t i = 0; i < kColumns; ++i) {
            start.push_back(random_normal(seed, 3, i));
        }
        LeastSquaresProblem problem = linear(a, b);
        problem.min_values.assign(kColumns, -0.3);
        problem.max_values.assign(kColumns, 0.4);
        const LeastSquaresSolution solution = solve_least_squares(problem, start);
        EXPECT_TRUE(solution.converged) << seed;
        for (std::size_t k = 0; k < kColumns; ++k) {
            double slope = 0.0;
            for (std::size_t i = 0; i < kRows; ++i) {
                slope += a[i * kColumns + k] * solution.residuals[i];
            }
            const double value = solution.parameters[k];
            if (value == -0.3) {
                EXPECT_GT(slope, -1e-6) << seed;
            } else if (value == 0.4) {
                EXPECT_LT(slope, 1e-6) << seed;
            } else {
                EXPECT_NEAR(slope, 0.0, 1e-6) << seed;
            }
            EXPECT_EQ(solution.at_bound[k], value == -0.3 || value == 0.4) << seed;
        }
        EXPECT_EQ(solve_least_squares(problem, start).parameters, solution.parameters);
    }
}

}  // namespace
}  // namespace earshot::propagation
