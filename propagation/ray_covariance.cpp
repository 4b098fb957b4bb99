// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_covariance.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

namespace {

/// Standard errors of each pair. Those of few replicates are uncertain themselves: they are mixed
/// with the mean of all pairs, as if that were a number of replicates.
std::vector<MetricVector> standard_errors(std::span<const std::vector<MetricVector>> deviations,
                                          std::size_t replicates) {
    constexpr double kReplicatesOfMean = 8.0;
    const auto count = static_cast<double>(replicates);
    std::vector<MetricVector> variances(deviations.size());
    MetricVector mean{};
    MetricVector pairs{};
    for (std::size_t pair = 0; pair < deviations.size(); ++pair) {
        for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
            double& variance = variances[pair][kind];
            for (std::size_t r = 0; r < replicates; ++r) {
                const double step = deviations[pair][r][kind];
                variance += step * step / (count * (count - 1.0));
            }
            mean[kind] += variance;
            pairs[kind] += variance > 0.0 ? 1.0 : 0.0;
        }
    }
    for (MetricVector& of_pair : variances) {
        for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
            if (of_pair[kind] > 0.0) {
                const double mixed =
                    ((count - 1.0) * of_pair[kind] + kReplicatesOfMean * mean[kind] / pairs[kind]) /
                    (count - 1.0 + kReplicatesOfMean);
                of_pair[kind] = mixed;
            }
            of_pair[kind] = std::sqrt(of_pair[kind]);
        }
    }
    return variances;
}

}  // namespace

// With z the deviations over their standard errors, the mean of z z^T over pairs and that of
// z_a z_b^T over two of them are covariances of exchangeable pairs: together never indefinite.
RayCovariance::RayCovariance(std::span<const std::vector<MetricVector>> deviations)
    : errors_(deviations.size(), MetricVector{}),
      of_one_(kMetricCount * kMetricCount, 0.0),
      of_two_(kMetricCount * kMetricCount, 0.0) {
    std::size_t replicates = deviations.empty() ? 0 : deviations.front().size();
    for (const std::vector<MetricVector>& of_pair : deviations) {
        replicates = std::min(replicates, of_pair.size());
    }
    if (replicates < 2) {
        return;
    }
    errors_ = standard_errors(deviations, replicates);
    const auto count = static_cast<double>(replicates);
    const auto pairs = static_cast<double>(deviations.size());
    for (std::size_t r = 0; r < replicates; ++r) {
        MetricVector sum{};
        std::vector<double> of_one(kMetricCount * kMetricCount, 0.0);
        for (std::size_t pair = 0; pair < deviations.size(); ++pair) {
            MetricVector z{};
            for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
                const double error = errors_[pair][kind];
                z[kind] = error > 0.0 ? deviations[pair][r][kind] / error : 0.0;
                sum[kind] += z[kind];
            }
            for (std::size_t cell = 0; cell < of_one.size(); ++cell) {
                of_one[cell] += z[cell / kMetricCount] * z[cell % kMetricCount];
            }
        }
        for (std::size_t cell = 0; cell < of_one.size(); ++cell) {
            const double all = sum[cell / kMetricCount] * sum[cell % kMetricCount];
            of_one_[cell] += of_one[cell] / (pairs * count * (count - 1.0));
            if (pairs > 1.0) {
                of_two_[cell] +=
                    (all - of_one[cell]) / (pairs * (pairs - 1.0) * count * (count - 1.0));
            }
        }
    }
}

}  // namespace earshot::propagation
