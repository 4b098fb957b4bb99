// SPDX-License-Identifier: MIT
#include "earshot/base/error_free.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace earshot {
namespace {

constexpr std::uint64_t kSeed = 8;

double random_number(std::uint64_t stream, std::uint64_t index) {
    const auto exponent = static_cast<int>(random_bits(kSeed, stream, index) % 80) - 40;
    return std::ldexp(random_between(kSeed, stream + 1, index, -1.0, 1.0), exponent);
}

TEST(TwoProduct, LeavesTheErrorThatFusedMultiplyAddFinds) {
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const double a = random_number(0, i);
        const double b = random_number(2, i);
        const DoublePair product = two_product(a, b);
        ASSERT_EQ(product.hi, a * b) << "seed " << kSeed << " index " << i;
        ASSERT_EQ(product.lo, std::fma(a, b, -(a * b))) << "seed " << kSeed << " index " << i;
    }
}

TEST(TwoSum, LosesNothing) {
    // The oracle: 113 bits hold the sum of two doubles whose exponents differ by less than 60.
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const double a = random_number(0, i);
        const double b = random_number(2, i) * std::abs(a);
        const DoublePair sum = two_sum(a, b);
        const __float128 exact = static_cast<__float128>(a) + static_cast<__float128>(b);
        const __float128 pair = static_cast<__float128>(sum.hi) + static_cast<__float128>(sum.lo);
        ASSERT_EQ(sum.hi, a + b) << "seed " << kSeed << " index " << i;
        ASSERT_TRUE(pair == exact) << "seed " << kSeed << " index " << i;
        const bool a_is_larger = std::abs(a) >= std::abs(b);
        const DoublePair fast = a_is_larger ? fast_two_sum(a, b) : fast_two_sum(b, a);
        ASSERT_EQ(fast.lo, sum.lo) << "seed " << kSeed << " index " << i;
    }
}

TEST(Split, MakesTwoHalvesWhoseSquaresAreExact) {
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const double a = random_number(0, i);
        const DoublePair halves = split(a);
        ASSERT_EQ(halves.hi + halves.lo, a) << "seed " << kSeed << " index " << i;
        ASSERT_EQ(std::fma(halves.hi, halves.hi, -(halves.hi * halves.hi)), 0.0) << i;
        ASSERT_EQ(std::fma(halves.lo, halves.lo, -(halves.lo * halves.lo)), 0.0) << i;
    }
}

}  // namespace
}  // namespace earshot
