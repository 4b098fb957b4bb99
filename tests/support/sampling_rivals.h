// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/base/halton.h"
#include "earshot/base/random.h"
#include "earshot/propagation/coherent_sampling.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

/// Other ways to choose items by importance, which coherent_samples() is compared with: those of
/// Barak et al. 2013 and what mends them. Items are told apart by their indices. Preconditions: the
/// importances are not all 0, and as for coherent_samples().
namespace earshot::support {

using propagation::WeightedSample;

/// Halton's sequence of a base, another one for each seed.
class HaltonStream {
public:
    HaltonStream(std::uint32_t base, std::uint64_t seed)
        : base_(base), shift_(random(seed, base, 0)) {}
    double at(std::uint64_t index) const { return shifted_radical_inverse(index, base_, shift_); }

private:
    std::uint32_t base_;
    double shift_;
};

/// Without regard to the importance.
inline std::vector<WeightedSample> uniform_samples(std::size_t items,
                                                   std::size_t budget,
                                                   std::uint64_t seed) {
    const HaltonStream halton(2, seed);
    std::vector<WeightedSample> samples;
    for (std::size_t j = 0; j < budget; ++j) {
        const auto index = static_cast<std::size_t>(halton.at(j) * static_cast<double>(items));
        samples.push_back({index, static_cast<double>(items) / static_cast<double>(budget)});
    }
    return samples;
}

/// The inverse of the cumulative distribution of the importances. `numbers(j)` in [0, 1).
template <typename Numbers>
std::vector<WeightedSample> inverse_transform(std::span<const double> importances,
                                              std::size_t budget,
                                              Numbers&& numbers) {
    std::vector<double> sums(importances.size());
    std::partial_sum(importances.begin(), importances.end(), sums.begin());
    std::vector<WeightedSample> samples;
    for (std::size_t j = 0; j < budget; ++j) {
        const double wanted = numbers(j) * sums.back();
        const auto found = std::upper_bound(sums.begin(), sums.end(), wanted);
        const auto index = static_cast<std::size_t>(found - sums.begin());
        samples.push_back(
            {index, sums.back() / (static_cast<double>(budget) * importances[index])});
    }
    return samples;
}

/// By Halton's sequence, the same at every update.
inline std::vector<WeightedSample> inverse_transform_samples(std::span<const double> importances,
                                                             std::size_t budget,
                                                             std::uint64_t seed) {
    const HaltonStream halton(2, seed);
    return inverse_transform(importances, budget, [&](std::size_t j) { return halton.at(j); });
}

/// By random numbers without any structure.
inline std::vector<WeightedSample> independent_samples(std::span<const double> importances,
                                                       std::size_t budget,
                                                       std::uint64_t seed) {
    const RandomStream stream(seed, 0);
    return inverse_transform(importances, budget, [&](std::size_t j) { return stream.at(j); });
}

/// One chain per choice, whose proposals are uniform and the same at every update; `accepts(f of
/// the proposal, f of the state, sum of f so far, number)`. Chain j has elements j, j + budget, ...
/// of Halton's sequence: with a base that has a divisor in common with the budget they would lie
/// next to each other.
template <typename Accepts>
std::vector<WeightedSample> chain_samples(std::span<const double> importances,
                                          std::size_t budget,
                                          std::size_t proposals,
                                          std::uint64_t seed,
                                          Accepts&& accepts) {
    const std::array<std::uint32_t, 5> primes = {3, 5, 7, 11, 13};
    const auto base = std::find_if(
        primes.begin(), primes.end(), [&](std::uint32_t prime) { return budget % prime != 0; });
    EARSHOT_ASSERT(base != primes.end());
    const HaltonStream proposal(*base, seed);
    const RandomStream numbers(seed, 1);
    const auto items = static_cast<double>(importances.size());
    std::vector<WeightedSample> samples;
    for (std::size_t j = 0; j < budget; ++j) {
        std::size_t state = 0;
        double sum = 0.0;
        for (std::size_t k = 0; k < proposals; ++k) {
            const std::uint64_t number = j + budget * k;
            const auto next = static_cast<std::size_t>(proposal.at(number) * items);
            sum += importances[next];
            if (k == 0 || accepts(importances[next], importances[state], sum, numbers.at(number))) {
                state = next;
            }
        }
        if (importances[state] > 0.0) {
            samples.push_back(
                {state,
                 items * sum / (static_cast<double>(proposals * budget) * importances[state])});
        }
    }
    return samples;
}

/// Independent Metropolis-Hastings (Barak et al. 2013, algorithm 1, where the first state is also
/// the first proposal). Biased.
inline std::vector<WeightedSample> metropolis_hastings_samples(std::span<const double> importances,
                                                               std::size_t budget,
                                                               std::size_t proposals,
                                                               std::uint64_t seed) {
    return chain_samples(
        importances, budget, proposals, seed, [](double next, double state, double, double number) {
            return next >= number * state;
        });
}

/// Resampled importance sampling (Talbot et al. 2005) by a reservoir, of the same proposals.
inline std::vector<WeightedSample> resampling_samples(std::span<const double> importances,
                                                      std::size_t budget,
                                                      std::size_t proposals,
                                                      std::uint64_t seed) {
    return chain_samples(
        importances, budget, proposals, seed, [](double next, double, double sum, double number) {
            return number * sum < next;
        });
}

}  // namespace earshot::support
