// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/internal/material_model.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// How the metrics of several pairs in one band vary together for the chance of the rays, which
/// reach many listeners. Replicates are few, so all pairs share their correlations: of metrics of
/// one pair, and of those of any two, each the mean over the pairs.
class RayCovariance {
public:
    /// `deviations`: of each pair (MaterialModel::ray_deviations()), of the same rays.
    explicit RayCovariance(std::span<const std::vector<MetricVector>> deviations);

    double covariance(std::size_t pair_a,
                      std::size_t kind_a,
                      std::size_t pair_b,
                      std::size_t kind_b) const {
        const std::size_t cell = kind_a * kMetricCount + kind_b;
        return errors_[pair_a][kind_a] * errors_[pair_b][kind_b] *
               (pair_a == pair_b ? of_one_[cell] : of_two_[cell]);
    }

private:
    std::vector<MetricVector> errors_;     // standard errors, per pair
    std::vector<double> of_one_, of_two_;  // correlations: kind, kind
};

}  // namespace earshot::propagation
