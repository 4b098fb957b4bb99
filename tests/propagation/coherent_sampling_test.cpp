// SPDX-License-Identifier: MIT
#include "earshot/propagation/coherent_sampling.h"

#include "earshot/base/random.h"
#include "earshot/base/standard_error.h"

#include <gtest/gtest.h>

#include "support/sampling_rivals.h"
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <span>
#include <vector>

namespace earshot::propagation {
namespace {

std::vector<SamplingKey> keys_of(std::size_t count, std::uint64_t seed) {
    std::vector<SamplingKey> keys;
    for (std::size_t i = 0; i < count; ++i) {
        keys.push_back(sampling_key(i, seed));
    }
    return keys;
}

std::vector<WeightedSample> samples_of(std::span<const double> importances,
                                       std::size_t budget,
                                       std::uint64_t seed) {
    return coherent_samples(importances, keys_of(importances.size(), seed), budget);
}

double estimate(std::span<const WeightedSample> samples, std::span<const double> values) {
    double sum = 0.0;
    for (const WeightedSample& sample : samples) {
        sum += sample.weight * values[sample.index];
    }
    return sum;
}

double sum_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// How many choices of `after` are not among those of `before`.
std::size_t new_choices(std::span<const WeightedSample> before,
                        std::span<const WeightedSample> after) {
    std::vector<std::size_t> old_ones, new_ones, difference;
    for (const WeightedSample& sample : before) {
        old_ones.push_back(sample.index);
    }
    for (const WeightedSample& sample : after) {
        new_ones.push_back(sample.index);
    }
    std::sort(old_ones.begin(), old_ones.end());
    std::sort(new_ones.begin(), new_ones.end());
    std::set_difference(new_ones.begin(),
                        new_ones.end(),
                        old_ones.begin(),
                        old_ones.end(),
                        std::back_inserter(difference));
    return difference.size();
}

/// Four maps of `side` x `side` with a few bright spots, as reflective shadow maps have them.
std::vector<double> peaked_maps(int side = 64) {
    std::vector<double> maps;
    for (int map = 0; map < 4; ++map) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const double dx = 64.0 * x / side - 10.0 - 12.0 * map;
                const double dy = 64.0 * y / side - 50.0 + 9.0 * map;
                maps.push_back(0.05 + std::exp(-(dx * dx + dy * dy) / (40.0 + 30.0 * map)));
            }
        }
    }
    return maps;
}

/// What the importance does not know: a part of the items is hidden, more of the faint ones.
std::vector<double> partly_hidden(std::span<const double> importances) {
    std::vector<double> values;
    for (std::size_t i = 0; i < importances.size(); ++i) {
        const bool is_hidden = i % 160 < (importances[i] > 0.3 ? 25 : 125);
        values.push_back(is_hidden ? 0.1 * importances[i] : importances[i]);
    }
    return values;
}

/// The means of estimates with many seeds, and the variance of one.
struct Trials {
    double mean = 0.0, error = 0.0, variance = 0.0;
};

template <typename Choose>
Trials trials(std::span<const double> values, Choose&& choose) {
    constexpr std::uint64_t kSeeds = 400;
    std::vector<double> estimates;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        estimates.push_back(estimate(choose(seed), values));
    }
    const double error = standard_error_of_mean(estimates);
    return {sum_of(estimates) / kSeeds, error, error * error * kSeeds};
}

/// The probability that an item is chosen, over all ways to put the items that are not certain into
/// as many slots as the budget, of which those without room are joined as the table tells.
std::vector<double> enumerated_probabilities(std::span<const double> importances,
                                             std::span<const std::size_t> certain,
                                             std::span<const std::size_t> joined) {
    std::vector<double> probabilities(importances.size(), 0.0);
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < importances.size(); ++i) {
        if (std::find(certain.begin(), certain.end(), i) != certain.end()) {
            probabilities[i] = 1.0;
        } else {
            others.push_back(i);
        }
    }
    const double ways =
        std::pow(static_cast<double>(joined.size()), static_cast<double>(others.size()));
    for (std::size_t way = 0; static_cast<double>(way) < ways; ++way) {
        std::vector<double> sums(joined.size(), 0.0);
        std::vector<std::size_t> slot_of(importances.size());
        std::size_t rest = way;
        for (const std::size_t i : others) {
            slot_of[i] = joined[rest % joined.size()];
            rest /= joined.size();
            sums[slot_of[i]] += importances[i];
        }
        for (const std::size_t i : others) {
            probabilities[i] += importances[i] / sums[slot_of[i]] / ways;
        }
    }
    return probabilities;
}

void expect_probabilities(std::span<const double> importances,
                          std::span<const std::size_t> certain,
                          std::vector<std::size_t> joined) {
    constexpr int kSeeds = 40000;
    std::vector<double> chosen(importances.size(), 0.0), weights(importances.size(), 0.0),
        squares(importances.size(), 0.0);
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        for (const WeightedSample& sample : samples_of(importances, joined.size(), seed)) {
            chosen[sample.index] += 1.0;
            weights[sample.index] += sample.weight;
            squares[sample.index] += sample.weight * sample.weight;
        }
    }
    const auto expected = enumerated_probabilities(importances, certain, joined);
    for (std::size_t i = 0; i < importances.size(); ++i) {
        const double p = expected[i];
        EXPECT_NEAR(chosen[i] / kSeeds, p, 4.5 * std::sqrt(p * (1.0 - p) / kSeeds) + 1e-12) << i;
        const double mean = weights[i] / kSeeds;
        const double spread = std::sqrt((squares[i] / kSeeds - mean * mean) / kSeeds);
        EXPECT_NEAR(mean, 1.0, 4.5 * spread + 1e-12) << i;
    }
}

TEST(CoherentSampling, ChoosesWithTheProbabilitiesOfAllWaysToFillTheSlots) {
    expect_probabilities(std::vector{1.0, 2.0, 1.5, 0.25, 2.5, 1.25}, {}, {0, 1});
    expect_probabilities(std::vector{1.0, 2.0, 1.5, 0.25, 2.5, 1.25}, {}, {0, 1, 2});
}

TEST(CoherentSampling, ChoosesImportantItemsWithCertainty) {
    // A third of 12 is less than 6; half of the other 6 is not more than 3.
    const std::vector<std::size_t> certain = {1, 3};
    expect_probabilities(std::vector{1.0, 6.0, 0.5, 3.0, 1.5}, certain, {0, 0, 0});
    // Two slots are left of four: 2 = 10b is joined with 0, and 3 = 11b with 1. A quarter of 13 and
    // a third of 7 are certain.
    expect_probabilities(std::vector{1.0, 6.0, 0.5, 3.0, 1.0, 1.5}, certain, {0, 1, 0, 1});
    for (std::uint64_t seed = 1; seed < 50; ++seed) {
        const auto samples = samples_of(std::vector{1.0, 6.0, 0.5, 3.0, 1.5}, 3, seed);
        ASSERT_EQ(samples.size(), 3);
        EXPECT_EQ(std::count_if(samples.begin(),
                                samples.end(),
                                [](const WeightedSample& s) { return s.weight == 1.0; }),
                  2);
    }
}

TEST(CoherentSampling, AnyBudgetThatSufficesChoosesAll) {
    const std::vector<double> importances = {0.5, 0.0, 3.0, 1e-9, 1.0};
    for (const std::size_t budget : {std::size_t{4}, std::size_t{5}, std::size_t{1} << 40}) {
        const auto samples = samples_of(importances, budget, 7);
        ASSERT_EQ(samples.size(), 4) << budget;
        for (const WeightedSample& sample : samples) {
            EXPECT_DOUBLE_EQ(sample.weight, 1.0);
            EXPECT_NE(sample.index, 1);
        }
    }
    EXPECT_TRUE(samples_of(importances, 0, 7).empty());
    EXPECT_TRUE(samples_of(std::vector(5, 0.0), 3, 7).empty());
    EXPECT_TRUE(samples_of({}, 3, 7).empty());
}

TEST(CoherentSampling, EstimatesTheSumOfTheImportancesExactly) {
    const std::vector<double> maps = peaked_maps();
    for (const std::size_t budget : std::vector<std::size_t>{1, 16, 1000}) {
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            const auto samples = samples_of(maps, budget, seed);
            EXPECT_LE(samples.size(), budget);
            EXPECT_NEAR(estimate(samples, maps) / sum_of(maps), 1.0, 1e-12);
        }
    }
}

// That Metropolis-Hastings fails shows that the test has power.
TEST(CoherentSampling, IsUnbiased) {
    const std::vector<double> maps = peaked_maps(32);
    const std::vector<double> values = partly_hidden(maps);
    constexpr std::size_t kBudget = 256;
    const double truth = sum_of(values);
    const Trials coherent =
        trials(values, [&](std::uint64_t seed) { return samples_of(maps, kBudget, seed); });
    EXPECT_NEAR(coherent.mean, truth, 4.0 * coherent.error);
    const Trials resampling = trials(values, [&](std::uint64_t seed) {
        return support::resampling_samples(maps, kBudget, 8, seed);
    });
    EXPECT_NEAR(resampling.mean, truth, 4.0 * resampling.error);
    const Trials metropolis = trials(values, [&](std::uint64_t seed) {
        return support::metropolis_hastings_samples(maps, kBudget, 8, seed);
    });
    EXPECT_GT(std::abs(metropolis.mean - truth), 4.0 * metropolis.error);
}

TEST(CoherentSampling, VariesLessThanIndependentChoices) {
    const std::vector<double> maps = peaked_maps(32);
    const std::vector<double> values = partly_hidden(maps);
    for (const std::size_t budget : std::vector<std::size_t>{16, 256}) {
        const Trials coherent =
            trials(values, [&](std::uint64_t seed) { return samples_of(maps, budget, seed); });
        const Trials independent = trials(values, [&](std::uint64_t seed) {
            return support::independent_samples(maps, budget, seed);
        });
        // A ratio of two variances of 400 estimates is certain within 15 %.
        EXPECT_LT(coherent.variance, 1.15 * independent.variance) << budget;
        EXPECT_NEAR(coherent.mean, sum_of(values), 4.0 * coherent.error) << budget;
    }
}

TEST(CoherentSampling, AChangeOfOneImportanceChangesAtMostOneChoice) {
    constexpr std::size_t kItems = 400, kBudget = 32;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        std::vector<double> importances;
        for (std::size_t i = 0; i < kItems; ++i) {
            importances.push_back(random_between(seed, 5, i, 0.5, 1.5));
        }
        const auto before = samples_of(importances, kBudget, seed);
        const auto item = static_cast<std::size_t>(kItems * random(seed, 6, 0));
        importances[item] = random_between(seed, 6, 1, 0.0, 5.0);  // none is a 32nd of all
        EXPECT_LE(new_choices(before, samples_of(importances, kBudget, seed)), 1) << seed;
        importances[item] = 0.0;
        EXPECT_LE(new_choices(before, samples_of(importances, kBudget, seed)), 1) << seed;
    }
}

TEST(CoherentSampling, AnItemThatBecomesCertainChangesAboutTwoChoices) {
    constexpr std::size_t kItems = 400, kBudget = 32;
    double changed = 0.0;
    constexpr std::uint64_t kSeeds = 300;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        std::vector<double> importances(kItems, 1.0);
        const auto before = samples_of(importances, kBudget, seed);
        importances[0] = 100.0;
        changed += static_cast<double>(new_choices(before, samples_of(importances, kBudget, seed)));
    }
    EXPECT_LT(changed / kSeeds, 2.5);
}

TEST(CoherentSampling, CommonFactorsAndTheOrderOfItemsChangeNothing) {
    const std::vector<double> maps = peaked_maps();
    std::vector<double> louder = maps, reversed(maps.rbegin(), maps.rend());
    for (double& value : louder) {
        value *= 1024.0;
    }
    std::vector<SamplingKey> keys = keys_of(maps.size(), 3);
    const auto samples = samples_of(maps, 64, 3);
    const auto of_louder = samples_of(louder, 64, 3);
    std::reverse(keys.begin(), keys.end());
    auto of_reversed = coherent_samples(reversed, keys, 64);
    std::reverse(of_reversed.begin(), of_reversed.end());
    ASSERT_EQ(samples.size(), of_louder.size());
    ASSERT_EQ(samples.size(), of_reversed.size());
    for (std::size_t k = 0; k < samples.size(); ++k) {
        EXPECT_EQ(samples[k].index, of_louder[k].index);
        EXPECT_EQ(samples[k].weight, of_louder[k].weight);
        EXPECT_EQ(samples[k].index, maps.size() - 1 - of_reversed[k].index);
        EXPECT_NEAR(samples[k].weight / of_reversed[k].weight, 1.0, 1e-12);
    }
}

// A change in one corner changes the distribution function everywhere after it.
TEST(CoherentSampling, LocalChangesStayLocal) {
    const std::vector<double> before = peaked_maps();
    std::vector<double> after = before;
    double change = 0.0;
    for (std::size_t y = 0; y < 12; ++y) {
        for (std::size_t x = 0; x < 12; ++x) {
            after[64 * y + x] += 0.07;
            change += 0.07;
        }
    }
    EXPECT_NEAR(change / sum_of(before), 0.0044, 0.003);
    constexpr std::size_t kBudget = 1024;
    const auto share_of_changes = [&](auto&& choose) {
        return static_cast<double>(new_choices(choose(before), choose(after))) / kBudget;
    };
    EXPECT_LT(share_of_changes([](const auto& f) { return samples_of(f, kBudget, 1); }), 0.03);
    EXPECT_GT(share_of_changes(
                  [](const auto& f) { return support::inverse_transform_samples(f, kBudget, 1); }),
              0.08);
}

}  // namespace
}  // namespace earshot::propagation
