// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/replicate_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace earshot::propagation {
namespace {

constexpr std::size_t kBins = 900;
constexpr std::size_t kBands = 10;
constexpr double kBin = 0.001;

/// A batch whose energy is its number, but for one band.
std::vector<double> batch(std::size_t number) {
    std::vector<double> energy(kBins * kBands, static_cast<double>(number));
    for (std::size_t n = 0; n < kBins; ++n) {
        energy[n * kBands + 3] = static_cast<double>(n);
    }
    return energy;
}

audio::HistogramReplicates replicates_of(std::size_t batches) {
    ReplicateSums sums(kBins, kBin, kBands);
    for (std::size_t number = 0; number < batches; ++number) {
        const std::vector<double> no_air_loss(kBins * kBands, 1.0);
        sums.add(batch(number), no_air_loss, 2.0);
    }
    return sums.replicates();
}

TEST(ReplicateSums, IntervalsCoverTheHistogramAndGrowLate) {
    const audio::HistogramReplicates replicates = replicates_of(4);
    const std::vector<std::size_t>& first = replicates.first_bin;
    ASSERT_GT(first.size(), 100U);
    EXPECT_EQ(first.front(), 0U);
    EXPECT_EQ(first.back(), kBins);
    for (std::size_t i = 0; i + 1 < first.size(); ++i) {
        ASSERT_LT(first[i], first[i + 1]);
        if (first[i] < 400) {
            EXPECT_EQ(first[i + 1] - first[i], 4U);
        } else {
            EXPECT_LE(first[i + 1] - first[i], 20U);
        }
        // The sum of the bins' numbers.
        const double a = static_cast<double>(first[i]), b = static_cast<double>(first[i + 1]);
        EXPECT_DOUBLE_EQ(replicates.energy[0][i][3], 0.5 * (b - a) * (a + b - 1.0));
    }
}

TEST(ReplicateSums, LongBinsAreIntervals) {
    ReplicateSums sums(20, 0.05, kBands);
    EXPECT_EQ(sums.first_bin().size(), 21U);
}

TEST(ReplicateSums, ThereAreNoneOfFewBatches) {
    EXPECT_TRUE(replicates_of(3).energy.empty());
    EXPECT_TRUE(replicates_of(3).first_bin.empty());
    EXPECT_EQ(replicates_of(4).energy.size(), 4U);
}

// Groups are as small as 64 of them allow, and every group has the next batches.
TEST(ReplicateSums, GroupsHaveEqualNumbersOfSuccessiveBatches) {
    for (const std::size_t batches : {4, 5, 63, 64, 65, 127, 128, 129, 130, 131, 257, 488, 1024}) {
        std::size_t size = 1;
        while (batches / size > 64) {
            size *= 2;
        }
        const audio::HistogramReplicates replicates = replicates_of(batches);
        ASSERT_EQ(replicates.energy.size(), batches / size) << batches;
        for (std::size_t group = 0; group < replicates.energy.size(); ++group) {
            // The mean number of its batches, in four bins.
            const double mean =
                static_cast<double>(group * size) + 0.5 * (static_cast<double>(size) - 1.0);
            EXPECT_DOUBLE_EQ(replicates.energy[group][0][0], 4.0 * mean) << batches;
        }
    }
}

}  // namespace
}  // namespace earshot::propagation
