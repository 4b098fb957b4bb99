// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"

#include "earshot/base/digest.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace earshot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kSeed = 20;
constexpr std::uint64_t kCount = 20000;

// The oracle: the C library in 64-bit-mantissa extended precision, 2048 times finer than a double.
static_assert(std::numeric_limits<long double>::digits == 64);

double error_in_ulps(double got, long double truth) {
    const double nearest = std::abs(static_cast<double>(truth));
    const double ulp = std::nextafter(nearest, kInfinity) - nearest;
    return static_cast<double>(std::abs(static_cast<long double>(got) - truth) /
                               static_cast<long double>(ulp));
}

struct Unary {
    std::string name;
    double (*function)(double) noexcept = nullptr;
    long double (*truth)(long double) = nullptr;
    double low = 0.0, high = 1.0;  // range of the argument, or of its logarithm to base 2
    bool logarithmic = false;
    double ulps = 1.0;
};

long double exp10_truth(long double x) {
    return std::pow(10.0L, x);
}

std::vector<Unary> unary_functions() {
    using L = long double (*)(long double);
    return {
        {"exp", math::exp, static_cast<L>(std::exp), -700.0, 709.0, false, 1.0},
        {"exp near 0", math::exp, static_cast<L>(std::exp), -1.0, 1.0, false, 1.0},
        {"log", math::log, static_cast<L>(std::log), -1074.0, 1024.0, true, 0.51},
        {"log near 1", math::log, static_cast<L>(std::log), 0.5, 2.0, false, 0.51},
        {"log2", math::log2, static_cast<L>(std::log2), -1074.0, 1024.0, true, 0.51},
        {"log2 near 1", math::log2, static_cast<L>(std::log2), 0.5, 2.0, false, 0.51},
        {"log10", math::log10, static_cast<L>(std::log10), -1074.0, 1024.0, true, 0.51},
        {"log10 near 1", math::log10, static_cast<L>(std::log10), 0.5, 2.0, false, 0.51},
        {"pow10", math::pow10, exp10_truth, -307.0, 308.0, false, 1.0},
        {"pow10 near 0", math::pow10, exp10_truth, -1.0, 1.0, false, 1.0},
        {"sin", math::sin, static_cast<L>(std::sin), -1e5, 1e5, false, 1.0},
        {"sin near 0", math::sin, static_cast<L>(std::sin), -4.0, 4.0, false, 1.0},
        {"cos", math::cos, static_cast<L>(std::cos), -1e5, 1e5, false, 1.0},
        {"cos near 0", math::cos, static_cast<L>(std::cos), -4.0, 4.0, false, 1.0},
        {"tan", math::tan, static_cast<L>(std::tan), -1e5, 1e5, false, 2.0},
        {"tan near 0", math::tan, static_cast<L>(std::tan), -4.0, 4.0, false, 2.0},
        {"atan", math::atan, static_cast<L>(std::atan), -60.0, 60.0, true, 1.0},
        {"atan near 0", math::atan, static_cast<L>(std::atan), -3.0, 3.0, false, 1.0},
        {"asin", math::asin, static_cast<L>(std::asin), -1.0, 1.0, false, 1.0},
        {"asin near 0", math::asin, static_cast<L>(std::asin), -60.0, 0.0, true, 1.0},
        {"acos", math::acos, static_cast<L>(std::acos), -1.0, 1.0, false, 1.0},
    };
}

double argument(const Unary& f, std::uint64_t stream, std::uint64_t index) {
    const double x = random_between(kSeed, stream, index, f.low, f.high);
    return f.logarithmic ? std::exp2(x) : x;
}

TEST(Math, StaysWithinTheStatedUlpsOfTheTrueValue) {
    std::uint64_t stream = 0;
    for (const Unary& f : unary_functions()) {
        double worst = 0.0;
        double worst_at = 0.0;
        for (std::uint64_t i = 0; i < kCount; ++i) {
            const double x = argument(f, stream, i);
            const double error = error_in_ulps(f.function(x), f.truth(x));
            if (!(error <= worst)) {
                worst = error;
                worst_at = x;
            }
        }
        EXPECT_LE(worst, f.ulps) << f.name << " at " << worst_at << ", seed " << kSeed;
        RecordProperty(f.name, std::to_string(worst));
        ++stream;
    }
}

TEST(Math, ReducesArgumentsNextToMultiplesOfHalfPi) {
    // The doubles nearest to n pi/2, where the reduction cancels most.
    for (int n = 1; n <= 63661; ++n) {
        const double x = static_cast<double>(n * 1.57079632679489661923132169163975144L);
        ASSERT_LE(error_in_ulps(math::sin(x), std::sin(static_cast<long double>(x))), 1.0) << n;
        ASSERT_LE(error_in_ulps(math::cos(x), std::cos(static_cast<long double>(x))), 1.0) << n;
    }
}

TEST(Math, AtanOfTwoStaysWithinTwoUlpsInEveryQuadrant) {
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const double angle = random_between(kSeed, 100, i, -math::kPi, math::kPi);
        const double size = std::exp2(random_between(kSeed, 101, i, -30.0, 30.0));
        const double y = size * std::sin(angle);
        const double x = size * std::cos(angle);
        const long double truth =
            std::atan2(static_cast<long double>(y), static_cast<long double>(x));
        ASSERT_LE(error_in_ulps(math::atan2(y, x), truth), 2.0) << y << ' ' << x;
    }
}

TEST(Math, PowStaysWithinOneUlp) {
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const double x = std::exp2(random_between(kSeed, 102, i, -40.0, 40.0));
        const double limit = std::min(1e3, 700.0 / std::abs(std::log(x)));
        const double y = random_between(kSeed, 103, i, -limit, limit);
        // The oracle itself: powl holds extended precision, far below a double's ulp.
        const long double truth =
            std::pow(static_cast<long double>(x), static_cast<long double>(y));
        ASSERT_LE(error_in_ulps(math::pow(x, y), truth), 1.0) << x << '^' << y;
    }
}

TEST(Math, IsExactWhereTheResultIsRepresentable) {
    for (int n = -1074; n < 1024; ++n) {
        ASSERT_EQ(math::log2(std::ldexp(1.0, n)), n);
    }
    double power = 1.0;
    for (int n = 0; n <= 22; ++n) {
        ASSERT_EQ(math::log10(power), n);
        ASSERT_EQ(math::pow10(n), power);
        power *= 10.0;
    }
    EXPECT_EQ(math::exp(0.0), 1.0);
    EXPECT_EQ(math::log(1.0), 0.0);
    EXPECT_EQ(math::cos(0.0), 1.0);
    EXPECT_EQ(math::acos(1.0), 0.0);
    EXPECT_EQ(math::acos(-1.0), math::kPi);
    EXPECT_EQ(math::pow(7.5, 1.0), 7.5);
}

TEST(Math, TakesSpecialValuesAsTheCLibraryDoes) {
    const double tiny = std::numeric_limits<double>::denorm_min();
    const double huge = std::numeric_limits<double>::max();
    const std::vector<double> values = {
        0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity, tiny, -tiny, huge, -huge, 2.0, -2.0};
    using D = double (*)(double);
    const std::vector<std::pair<double (*)(double) noexcept, D>> pairs = {
        {math::exp, std::exp},
        {math::log, std::log},
        {math::log2, std::log2},
        {math::atan, std::atan},
        {math::log10, std::log10}};
    for (std::size_t f = 0; f < pairs.size(); ++f) {
        EXPECT_TRUE(std::isnan(pairs[f].first(kNan))) << f;
        for (const double x : values) {
            const double want = pairs[f].second(x);
            const double got = pairs[f].first(x);
            if (std::isnan(want)) {
                EXPECT_TRUE(std::isnan(got)) << f << " at " << x;
            } else {
                EXPECT_DOUBLE_EQ(got, want) << f << " at " << x;
                EXPECT_EQ(std::signbit(got), std::signbit(want)) << f << " at " << x;
            }
        }
    }
}

TEST(Math, CircularFunctionsOfNoNumberAreNoNumbers) {
    for (const double x : {kInfinity, -kInfinity, kNan}) {
        EXPECT_TRUE(std::isnan(math::sin(x)));
        EXPECT_TRUE(std::isnan(math::cos(x)));
        EXPECT_TRUE(std::isnan(math::tan(x)));
        EXPECT_TRUE(std::isnan(math::asin(x)));
        EXPECT_TRUE(std::isnan(math::acos(x)));
    }
    EXPECT_TRUE(std::isnan(math::asin(1.0000001)));
    EXPECT_TRUE(std::isnan(math::acos(-1.0000001)));
    EXPECT_LE(std::abs(math::sin(1e300)), 1.0);
    EXPECT_TRUE(std::signbit(math::sin(-0.0)));
    EXPECT_TRUE(std::signbit(math::tan(-0.0)));
    EXPECT_TRUE(std::signbit(math::asin(-0.0)));
}

TEST(Math, AtanOfTwoTakesZerosAndInfinitiesAsTheCLibraryDoes) {
    const std::vector<double> values = {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity};
    for (const double y : values) {
        for (const double x : values) {
            const double got = math::atan2(y, x);
            EXPECT_DOUBLE_EQ(got, std::atan2(y, x)) << y << ' ' << x;
            EXPECT_EQ(std::signbit(got), std::signbit(std::atan2(y, x))) << y << ' ' << x;
        }
    }
    EXPECT_TRUE(std::isnan(math::atan2(kNan, 1.0)));
    EXPECT_TRUE(std::isnan(math::atan2(1.0, kNan)));
}

TEST(Math, PowTakesSpecialValues) {
    const std::vector<double> bases = {0.0, 0.5, 1.0, 2.0, kInfinity};
    const std::vector<double> exponents = {-kInfinity, -1.5, 0.0, 1.5, kInfinity};
    for (const double x : bases) {
        for (const double y : exponents) {
            EXPECT_DOUBLE_EQ(math::pow(x, y), std::pow(x, y)) << x << ' ' << y;
        }
    }
    EXPECT_TRUE(std::isnan(math::pow(-1.0, 2.0)));
    EXPECT_TRUE(std::isnan(math::pow(kNan, 2.0)));
    EXPECT_TRUE(std::isnan(math::pow(2.0, kNan)));
    EXPECT_EQ(math::pow(2.0, 5000.0), kInfinity);
    EXPECT_EQ(math::pow(2.0, -5000.0), 0.0);
    EXPECT_EQ(math::pow(2.0, 1e300), kInfinity);
    EXPECT_EQ(math::pow10(400.0), kInfinity);
    EXPECT_EQ(math::pow10(-400.0), 0.0);
    EXPECT_EQ(math::pow10(-kInfinity), 0.0);
    EXPECT_TRUE(std::isnan(math::pow10(kNan)));
}

TEST(Math, UnderflowsGraduallyToTheTrueSubnormal) {
    for (int i = 0; i < 370; ++i) {
        const double x = -708.0 - 0.1 * i;
        const long double truth = std::exp(static_cast<long double>(x));
        const double ulp = std::numeric_limits<double>::denorm_min();
        EXPECT_LE(std::abs(static_cast<long double>(math::exp(x)) - truth),
                  std::max(static_cast<long double>(ulp), truth * 0x1p-52L))
            << x;
    }
}

// The promise of base/math.h: these bits are the same on every x86-64 CPU, with every compiler.
// The digest has to be the same for g++ and for clang++ and with the CPU's features masked
// (GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F). Arguments are made without libm.
TEST(Math, GivesTheSameBitsOnEveryMachine) {
    constexpr std::uint64_t kGolden = 0xe8623269589b0531ULL;
    Digest digest;
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const auto between = [i](std::uint64_t stream, double low, double high) {
            return random_between(kSeed, stream, i, low, high);
        };
        const int exponent = static_cast<int>(between(200, -1060.0, 1000.0));
        const double positive = std::ldexp(between(201, 1.0, 2.0), exponent);
        digest.add(math::exp(between(202, -740.0, 709.0)));
        digest.add(math::log(positive));
        digest.add(math::log2(positive));
        digest.add(math::log10(positive));
        digest.add(math::pow10(between(203, -320.0, 308.0)));
        digest.add(math::pow(between(204, 0.0, 10.0), between(205, -50.0, 50.0)));
        digest.add(math::sin(between(206, -1e5, 1e5)));
        digest.add(math::cos(between(207, -10.0, 10.0)));
        digest.add(math::tan(between(208, -10.0, 10.0)));
        digest.add(math::atan(between(209, -10.0, 10.0)));
        digest.add(math::atan2(between(210, -1.0, 1.0), between(211, -1.0, 1.0)));
        digest.add(math::asin(between(212, -1.0, 1.0)));
        digest.add(math::acos(between(213, -1.0, 1.0)));
    }
    EXPECT_EQ(digest.value(), kGolden);
}

}  // namespace
}  // namespace earshot
