// SPDX-License-Identifier: MIT
#include "earshot/audio/temporal_difference.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace earshot::audio {
namespace {

/// Energy per interval and band.
std::vector<double> interval_energies(const EnergyHistogram& histogram,
                                      std::size_t bands,
                                      std::size_t bins) {
    std::vector<double> energies((histogram.energy.size() + bins - 1) / bins * bands, 0.0);
    for (std::size_t n = 0; n < histogram.energy.size(); ++n) {
        for (std::size_t band = 0; band < bands; ++band) {
            energies[n / bins * bands + band] += histogram.energy[n][band];
        }
    }
    return energies;
}

/// Nothing where there is no exact energy.
std::vector<std::optional<double>> ratios(const EnergyHistogram& estimate,
                                          const EnergyHistogram& exact,
                                          std::size_t bands,
                                          std::size_t bins) {
    const std::vector<double> estimated = interval_energies(estimate, bands, bins);
    const std::vector<double> energies = interval_energies(exact, bands, bins);
    EARSHOT_ASSERT(estimated.size() == energies.size());
    std::vector<std::optional<double>> result(energies.size());
    for (std::size_t i = 0; i < energies.size(); ++i) {
        if (energies[i] > 0.0) {
            result[i] = estimated[i] / energies[i];
        }
    }
    return result;
}

class MeanSquare {
public:
    void add(double value) {
        sum_ += value * value;
        count_ += 1.0;
    }
    double root() const { return count_ > 0.0 ? std::sqrt(sum_ / count_) : 0.0; }

private:
    double sum_ = 0.0, count_ = 0.0;
};

}  // namespace

TemporalDifference temporal_difference(std::span<const EnergyHistogram> estimates,
                                       std::span<const EnergyHistogram> exact,
                                       std::size_t bands,
                                       std::size_t bins) {
    EARSHOT_ASSERT(estimates.size() == exact.size() && bins > 0);
    MeanSquare difference, error;
    std::vector<std::optional<double>> before;
    for (std::size_t u = 0; u < estimates.size(); ++u) {
        std::vector<std::optional<double>> now = ratios(estimates[u], exact[u], bands, bins);
        for (std::size_t i = 0; i < now.size(); ++i) {
            if (!now[i]) {
                continue;
            }
            error.add(*now[i] - 1.0);
            if (u > 0 && before[i]) {
                difference.add(*now[i] - *before[i]);
            }
        }
        before = std::move(now);
    }
    return {difference.root(), error.root()};
}

}  // namespace earshot::audio
