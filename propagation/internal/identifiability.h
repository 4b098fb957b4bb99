// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What data tell of parameters, each in units of its prior's standard deviation about the prior's
/// mean. In an eigenvector of the covariance the data leave the share c of the prior's variance:
/// c = 1 where they tell nothing, 0 where they tell all.
class Identifiability {
public:
    /// `covariance`: of data and prior together, row-major, count x count. `data_scale`: variance
    /// of the data that it does not consider; they count by so much less.
    Identifiability(std::span<const double> covariance, std::size_t count, double data_scale = 1.0);

    /// The variance of a weighted sum, data and prior together.
    double variance(std::span<const double> weights) const;
    /// Of one parameter: data and prior together, and the data alone; infinite where they do not
    /// tell it.
    double variance_of(std::size_t parameter) const;
    double data_variance_of(std::size_t parameter) const;
    /// The number of parameters, in effect, that the data tell.
    double told_parameters() const;

    /// Parameters that the data do not tell one by one, those together that they do not part: they
    /// stand together in directions in which the data leave more than half of the prior's
    /// deviation.
    std::vector<std::vector<std::size_t>> groups() const;
    /// The direction within some of the parameters that data and prior know best.
    std::vector<double> known_direction(std::span<const std::size_t> group) const;

private:
    double covariance(std::size_t row, std::size_t column) const {
        return covariance_[row * count_ + column];
    }

    std::size_t count_;
    std::vector<double> covariance_;  // row-major
    std::vector<double> shares_;      // of the prior's variance, per eigenvector
    std::vector<double> directions_;  // eigenvectors, a row each
};

}  // namespace earshot::propagation
