// SPDX-License-Identifier: MIT
#include "earshot/visibility/missed_share.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <cmath>

namespace earshot::visibility {
namespace {

/// The probability of at most k successes in n trials, term by term with the standard library's
/// logarithm of the gamma function.
double probability_of_at_most(int k, int n, double p) {
    double sum = 0.0;
    for (int i = 0; i <= k; ++i) {
        sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) +
                        i * std::log(p) + (n - i) * std::log1p(-p));
    }
    return sum;
}

TEST(ClopperPearson, HasAClosedFormWithoutSuccesses) {
    for (const int n : {1, 2, 10, 1000, 65536, 2097152}) {
        const auto trials = static_cast<std::uint64_t>(n);
        const double expected = -std::expm1(std::log(0.05) / n);  // 1 - 0.05^(1/n)
        EXPECT_NEAR(clopper_pearson_upper(0, trials, 0.95), expected, 1e-9 * expected) << n;
    }
}

TEST(ClopperPearson, EqualsPublishedTables) {
    // One-sided 95 % upper limits (two-sided 90 % intervals).
    EXPECT_NEAR(clopper_pearson_upper(1, 10, 0.95), 0.3942, 5e-5);
    EXPECT_NEAR(clopper_pearson_upper(0, 20, 0.95), 0.1391, 5e-5);
    EXPECT_NEAR(clopper_pearson_upper(5, 100, 0.95), 0.1023, 5e-5);
    EXPECT_EQ(clopper_pearson_upper(7, 7, 0.95), 1.0);
    EXPECT_EQ(clopper_pearson_upper(0, 0, 0.95), 1.0);
}

TEST(ClopperPearson, LeavesTheTailItPromises) {
    for (const int n : {5, 40, 300, 65536}) {
        for (const int k : {0, 1, 2, 4}) {
            for (const double confidence : {0.5, 0.95, 0.99}) {
                const double bound = clopper_pearson_upper(
                    static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(n), confidence);
                EXPECT_NEAR(probability_of_at_most(k, n, bound), 1.0 - confidence, 1e-7)
                    << k << " of " << n;
            }
        }
    }
    const double bound = clopper_pearson_upper(3000, 65536, 0.95);
    EXPECT_NEAR(probability_of_at_most(3000, 65536, bound), 0.05, 1e-6);
}

TEST(ClopperPearson, CoversTheTruthAsOftenAsItSays) {
    support::Dice dice(5);
    for (const double truth : {0.002, 0.03, 0.4}) {
        constexpr int kBatches = 2000;
        constexpr int kTrials = 500;
        int covered = 0;
        for (int batch = 0; batch < kBatches; ++batch) {
            std::uint64_t successes = 0;
            for (int i = 0; i < kTrials; ++i) {
                successes += dice.between(0.0, 1.0) < truth ? 1 : 0;
            }
            covered += clopper_pearson_upper(successes, kTrials, 0.95) >= truth ? 1 : 0;
        }
        // At least 95 %, but for three standard deviations of the count.
        EXPECT_GE(covered, 0.95 * kBatches - 3.0 * std::sqrt(kBatches * 0.95 * 0.05)) << truth;
    }
}

TEST(MissedShare, IsUnknownWithoutRaysAndNeverZeroWithThem) {
    EXPECT_EQ(MissedShare{}.upper_bound(), 1.0);
    const MissedShare none = {.rays = 65536, .missed = 0};
    EXPECT_EQ(none.estimate(), 0.0);
    EXPECT_GT(none.upper_bound(), 2.99 / 65536);
    EXPECT_LT(none.upper_bound(), 3.0 / 65536);
    const MissedShare some = {.rays = 1000, .missed = 12};
    EXPECT_EQ(some.estimate(), 0.012);
    EXPECT_GT(some.upper_bound(), some.estimate());
}

}  // namespace
}  // namespace earshot::visibility
