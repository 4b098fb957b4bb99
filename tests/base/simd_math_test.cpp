// SPDX-License-Identifier: MIT
#include "earshot/base/digest.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/simd_math_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

/// In place, of multiples of 8 numbers.
void wide_exp(std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); i += Doubles::kCount) {
        exp(Doubles::load_unaligned(&x[i])).store_unaligned(&x[i]);
    }
}

void wide_pow10(std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); i += Doubles::kCount) {
        pow10(Doubles::load_unaligned(&x[i])).store_unaligned(&x[i]);
    }
}

void wide_log(std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); i += Doubles::kCount) {
        log(Doubles::load_unaligned(&x[i])).store_unaligned(&x[i]);
    }
}

void wide_sin(std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); i += Doubles::kCount) {
        sin_cos(Doubles::load_unaligned(&x[i])).sin.store_unaligned(&x[i]);
    }
}

void wide_cos(std::span<double> x) {
    for (std::size_t i = 0; i < x.size(); i += Doubles::kCount) {
        sin_cos(Doubles::load_unaligned(&x[i])).cos.store_unaligned(&x[i]);
    }
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot {
namespace {

HWY_EXPORT(wide_exp);
HWY_EXPORT(wide_pow10);
HWY_EXPORT(wide_log);
HWY_EXPORT(wide_sin);
HWY_EXPORT(wide_cos);

constexpr std::uint64_t kCount = 20000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> between(std::uint64_t stream, double low, double high) {
    std::vector<double> values(kCount);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        values[i] = random_between(11, stream, i, low, high);
    }
    return values;
}

std::vector<double> of_all_magnitudes() {
    std::vector<double> values(kCount);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const int exponent = static_cast<int>(random_between(11, 1, i, -1074.0, 1024.0));
        values[i] = std::ldexp(random_between(11, 2, i, 1.0, 2.0), exponent);
    }
    return values;
}

/// Every lane against the scalar function, bit for bit, on every instruction set.
template <typename Wide>
void expect_scalar_bits(Wide&& wide, double (*scalar)(double), const std::vector<double>& x) {
    for (const std::string& target : simd_targets()) {
        SCOPED_TRACE(target);
        override_simd_target(target);
        std::vector<double> found = x;
        wide(found);
        std::uint64_t wrong = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double expected = scalar(x[i]);
            const bool same =
                std::bit_cast<std::uint64_t>(found[i]) == std::bit_cast<std::uint64_t>(expected);
            if (!same && !(std::isnan(found[i]) && std::isnan(expected)) && ++wrong < 5) {
                ADD_FAILURE() << x[i] << ": " << found[i] << ", not " << expected;
            }
        }
        EXPECT_EQ(wrong, 0U);
    }
    override_simd_target("auto");
}

TEST(SimdMath, ExpHasTheBitsOfTheScalarFunction) {
    const auto wide = [](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_exp)(x); };
    expect_scalar_bits(wide, math::exp, between(3, -745.5, 710.0));
    expect_scalar_bits(wide, math::exp, between(4, -1.0, 1.0));
    expect_scalar_bits(wide,
                       math::exp,
                       {0.0,
                        -0.0,
                        kInfinity,
                        -kInfinity,
                        kNan,
                        7.09782712893383973096e+02,
                        709.79,
                        -708.5,
                        -745.2,
                        1e300,
                        -1e300,
                        0.5,
                        -0.5,
                        1e-300,
                        0x1p-60,
                        0.34657359027997264});
}

TEST(SimdMath, Pow10HasTheBitsOfTheScalarFunction) {
    const auto wide = [](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_pow10)(x); };
    expect_scalar_bits(wide, math::pow10, between(6, -330.0, 0.0));
    expect_scalar_bits(wide, math::pow10, between(7, -1.0, 0.0));
    expect_scalar_bits(wide, math::pow10, {0.0, -0.0, -1.0, -2.0, -0.5, -1e-300, -400.0, -1e9});
}

TEST(SimdMath, LogHasTheBitsOfTheScalarFunction) {
    const auto wide = [](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_log)(x); };
    expect_scalar_bits(wide, math::log, of_all_magnitudes());
    expect_scalar_bits(wide, math::log, between(5, 0.4, 2.1));
    expect_scalar_bits(wide,
                       math::log,
                       {0.0,
                        -0.0,
                        kInfinity,
                        -kInfinity,
                        kNan,
                        -1.0,
                        1.0,
                        std::numeric_limits<double>::denorm_min(),
                        std::numeric_limits<double>::min(),
                        std::numeric_limits<double>::max(),
                        0x1.6a09e667f3bcdp-1,
                        0x1.6a09e667f3bccp-1,
                        2.0,
                        0.5,
                        1e-310,
                        1e-10});
}

TEST(SimdMath, SinAndCosHaveTheBitsOfTheScalarFunctions) {
    const auto wide_sine = [](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_sin)(x); };
    const auto wide_cosine = [](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_cos)(x); };
    std::vector<double> near_axes(kCount);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const double turns = std::floor(random_between(11, 6, i, -60000.0, 60000.0));
        near_axes[i] = turns * (0.5 * math::kPi);
    }
    const std::vector<double> special = {0.0,
                                         -0.0,
                                         1e-300,
                                         -1e-300,
                                         0x1p-27,
                                         0x1p-28,
                                         kNan,
                                         1e5,
                                         -1e5,
                                         0.5,
                                         -0.5,
                                         1.0,
                                         2.0,
                                         3.0,
                                         0.78539816339744828,
                                         kInfinity};
    for (const std::vector<double>& x :
         {between(7, -1e5, 1e5), between(8, -10.0, 10.0), near_axes, special}) {
        expect_scalar_bits(wide_sine, math::sin, x);
        expect_scalar_bits(wide_cosine, math::cos, x);
    }
}

// As Math.GivesTheSameBitsOnEveryMachine, of the wide functions.
TEST(SimdMath, GivesTheSameBitsOnEveryMachine) {
    for (const std::string& target : simd_targets()) {
        SCOPED_TRACE(target);
        override_simd_target(target);
        Digest digest;
        const auto add = [&](auto&& wide, std::vector<double> x) {
            wide(std::span(x));
            for (const double value : x) {
                digest.add(value);
            }
        };
        add(
            [](std::span<double> x) {
                HWY_DYNAMIC_DISPATCH(wide_exp)
                (x);
            },
            between(3, -745.5, 710.0));
        add([](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_log)(x); }, of_all_magnitudes());
        add([](std::span<double> x) { HWY_DYNAMIC_DISPATCH(wide_sin)(x); }, between(7, -1e5, 1e5));
        add(
            [](std::span<double> x) {
                HWY_DYNAMIC_DISPATCH(wide_cos)
                (x);
            },
            between(8, -10.0, 10.0));
        EXPECT_EQ(digest.value(), 7881479036844364840ULL);
    }
    override_simd_target("auto");
}

}  // namespace
}  // namespace earshot
#endif
