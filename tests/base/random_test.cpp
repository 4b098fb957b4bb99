// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <set>

namespace earshot {
namespace {

TEST(Random, GivesTheNumbersItAlwaysGave) {
    // Every result made with a seed depends on these.
    EXPECT_EQ(random_bits(0, 0, 0), 0x238275bc38fcbe91ULL);
    EXPECT_EQ(random_bits(1, 0, 0), 0xb18a02f46d8d86c3ULL);
    EXPECT_EQ(random_bits(1, 2, 3), 0xd0734750fde362b3ULL);
    EXPECT_EQ(random(1, 2, 3), 0x1.a0e68ea1fbc6cp-1);
}

TEST(Random, StartsAsSplitMix64Does) {
    // One key alone is SplitMix64's first output for that seed: 0 gives 0xe220a8397b1dcdaf (Vigna's
    // splitmix64.c). random_bits(0, s, i) chains the same mixer, so the stream that cancels the
    // first round's output leaves mix(0) once more, and so does the index.
    constexpr std::uint64_t kFirst = 0xe220a8397b1dcdafULL;
    EXPECT_EQ(random_bits(0, kFirst, kFirst), kFirst);
}

TEST(Random, AStreamGivesTheSameNumbers) {
    const RandomStream stream(1, 2);
    for (std::uint64_t index = 0; index < 100; ++index) {
        EXPECT_EQ(stream.bits(index), random_bits(1, 2, index));
        EXPECT_EQ(stream.at(index), random(1, 2, index));
    }
}

TEST(Random, LiesInTheUnitIntervalEvenly) {
    constexpr std::size_t kBins = 64;
    constexpr std::size_t kCount = 64000;
    std::array<double, kBins> bins{};
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const double x = random(7, 1, i);
        ASSERT_GE(x, 0.0);
        ASSERT_LT(x, 1.0);
        bins[static_cast<std::size_t>(x * static_cast<double>(kBins))] += 1.0;
    }
    const double expected = static_cast<double>(kCount) / static_cast<double>(kBins);
    double chi_squared = 0.0;
    for (const double count : bins) {
        chi_squared += (count - expected) * (count - expected) / expected;
    }
    // 63 degrees of freedom: mean 63, standard deviation sqrt(126); five of them either way.
    EXPECT_NEAR(chi_squared, 63.0, 5.0 * std::sqrt(126.0));
}

TEST(Random, ChangesHalfTheBitsWithAnyKey) {
    constexpr int kCount = 2000;
    std::array<double, 3> flipped{};
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const std::uint64_t bits = random_bits(3, 5, i);
        const std::uint64_t one = std::uint64_t{1} << (i % 64);
        flipped[0] += std::popcount(bits ^ random_bits(3 ^ one, 5, i));
        flipped[1] += std::popcount(bits ^ random_bits(3, 5 ^ one, i));
        flipped[2] += std::popcount(bits ^ random_bits(3, 5, i ^ one));
    }
    // Mean 32 of 64 bits with standard deviation 4 / sqrt(kCount) = 0.09; five of them.
    for (const double total : flipped) {
        EXPECT_NEAR(total / kCount, 32.0, 0.45);
    }
}

TEST(Random, DiffersBetweenNeighbouringKeys) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        for (std::uint64_t stream = 0; stream < 20; ++stream) {
            for (std::uint64_t index = 0; index < 20; ++index) {
                seen.insert(random_bits(seed, stream, index));
            }
        }
    }
    EXPECT_EQ(seen.size(), 8000U);
}

TEST(Random, StretchesToTheIntervalAskedFor) {
    double sum = 0.0;
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const double x = random_between(9, 0, i, -3.0, 5.0);
        ASSERT_GE(x, -3.0);
        ASSERT_LE(x, 5.0);
        sum += x;
    }
    // Standard deviation of the mean: 8 / sqrt(12 * 10000) = 0.023; five of them.
    EXPECT_NEAR(sum / 10000.0, 1.0, 0.12);
}

}  // namespace
}  // namespace earshot
