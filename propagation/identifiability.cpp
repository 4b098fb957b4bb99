// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/identifiability.h"

#include "earshot/base/assert.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace earshot::propagation {

namespace {

using Matrix = Eigen::MatrixXd;

/// Data that leave more of the prior's variance do not tell a direction: they have not halved the
/// deviation.
constexpr double kUntoldShare = 0.25;

Eigen::Index index(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

}  // namespace

Identifiability::Identifiability(std::span<const double> covariance,
                                 std::size_t count,
                                 double data_scale)
    : count_(count), covariance_(count * count, 0.0) {
    EARSHOT_ASSERT(covariance.size() == count * count);
    if (count == 0) {
        return;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        Eigen::Map<const Matrix>(covariance.data(), index(count), index(count)));
    // The inverse of a share is 1 + the information of the data, of which the scale is the
    // variance.
    constexpr double kMinShare = 1e-12;
    for (std::size_t e = 0; e < count; ++e) {
        const double share = std::clamp(solver.eigenvalues()(index(e)), kMinShare, 1.0);
        shares_.push_back(1.0 / (1.0 + (1.0 / share - 1.0) / data_scale));
        for (std::size_t i = 0; i < count; ++i) {
            directions_.push_back(solver.eigenvectors()(index(i), index(e)));
        }
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = 0; j < count; ++j) {
                covariance_[i * count + j] +=
                    shares_[e] * directions_[e * count + i] * directions_[e * count + j];
            }
        }
    }
}

double Identifiability::variance(std::span<const double> weights) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
        for (std::size_t j = 0; j < count_; ++j) {
            sum += weights[i] * covariance(i, j) * weights[j];
        }
    }
    return sum;
}

double Identifiability::variance_of(std::size_t parameter) const {
    return covariance(parameter, parameter);
}

double Identifiability::data_variance_of(std::size_t parameter) const {
    // A direction that the data leave as it was, but for rounding, is not told by them.
    constexpr double kNothing = 1.0 - 1e-9, kRounding = 1e-9;
    double sum = 0.0;
    for (std::size_t e = 0; e < count_; ++e) {
        const double part =
            directions_[e * count_ + parameter] * directions_[e * count_ + parameter];
        if (shares_[e] >= kNothing) {
            if (part > kRounding) {
                return std::numeric_limits<double>::infinity();
            }
            continue;
        }
        sum += part * shares_[e] / (1.0 - shares_[e]);
    }
    return sum;
}

double Identifiability::told_parameters() const {
    return static_cast<double>(count_) - std::accumulate(shares_.begin(), shares_.end(), 0.0);
}

std::vector<std::vector<std::size_t>> Identifiability::groups() const {
    // The projection onto the directions that are not told does not depend on how vectors of equal
    // shares are chosen.
    std::vector<double> projection(count_ * count_, 0.0);
    for (std::size_t e = 0; e < count_; ++e) {
        for (std::size_t i = 0; i < count_ && shares_[e] > kUntoldShare; ++i) {
            for (std::size_t j = 0; j < count_; ++j) {
                projection[i * count_ + j] +=
                    directions_[e * count_ + i] * directions_[e * count_ + j];
            }
        }
    }
    // Parameters that share a tenth of such a direction are not parted by the data.
    constexpr double kLink = 0.1;
    std::vector<std::vector<std::size_t>> result;
    std::vector<bool> is_taken(count_, false);
    for (std::size_t first = 0; first < count_; ++first) {
        if (is_taken[first] || covariance(first, first) <= kUntoldShare) {
            continue;
        }
        std::vector<std::size_t> group = {first};
        is_taken[first] = true;
        for (std::size_t k = 0; k < group.size(); ++k) {
            for (std::size_t i = 0; i < count_; ++i) {
                if (!is_taken[i] && std::abs(projection[group[k] * count_ + i]) > kLink) {
                    is_taken[i] = true;
                    group.push_back(i);
                }
            }
        }
        std::sort(group.begin(), group.end());
        result.push_back(std::move(group));
    }
    std::sort(result.begin(), result.end());
    return result;
}

std::vector<double> Identifiability::known_direction(std::span<const std::size_t> group) const {
    Matrix part(index(group.size()), index(group.size()));
    for (std::size_t i = 0; i < group.size(); ++i) {
        for (std::size_t j = 0; j < group.size(); ++j) {
            part(index(i), index(j)) = covariance(group[i], group[j]);
        }
    }
    // Ascending: the first has the smallest variance.
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(part);
    const Eigen::VectorXd direction = solver.eigenvectors().col(0);
    return {direction.begin(), direction.end()};
}

}  // namespace earshot::propagation
