// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/simd_lanes_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/float_lanes-inl.h"

#ifndef EARSHOT_TESTS_BASE_SIMD_LANES
#define EARSHOT_TESTS_BASE_SIMD_LANES
namespace earshot {

constexpr std::size_t kCount = 8;

/// What every operation makes of two rows of numbers.
template <typename Real>
struct Results {
    alignas(64) Real sum[kCount], difference[kCount], product[kCount], quotient[kCount];
    alignas(64) Real smaller[kCount], larger[kCount], magnitude[kCount], selected[kCount];
    alignas(64) Real fused[kCount], negated[kCount], opposite[kCount];
    std::uint32_t less, at_most, both, either, only_less, chosen, any_less;
};

template <typename Real>
struct Rows {
    alignas(64) Real a[kCount], b[kCount];
};

struct Shuffles {
    alignas(32) float by_one[4], by_two[4], lower[4], upper[4], low[4], high[4], swapped[8];
    alignas(32) float integers[4], shorts[8], from_bits[8];
    std::uint32_t bits[8], masked[3];
    std::array<std::uint32_t, 9> first;
    float smallest, largest;
    alignas(32) float keys[8];
    std::uint32_t values[8];
    std::size_t compressed;
};

/// 16 numbers read as pairs, the pairs written in opposite order, and the rows of fours.
struct Interleaved {
    alignas(64) double first[kCount], second[kCount], reversed[kCount];
    double pairs[2 * kCount], fours[4 * kCount];
};

}  // namespace earshot
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

template <typename Row, typename Real>
void compute(const Rows<Real>& rows, std::size_t i, Results<Real>& out) {
    const Row a = Row::load(rows.a + i);
    const Row b = Row::load_unaligned(rows.b + i);
    (a + b).store(out.sum + i);
    (a - b).store(out.difference + i);
    (a * b).store(out.product + i);
    (a / b).store(out.quotient + i);
    min(a, b).store(out.smaller + i);
    max(a, b).store(out.larger + i);
    abs(a).store(out.magnitude + i);
    select(a < b, a, Row(Real(7))).store_unaligned(out.selected + i);
    mul_add(a, b, Row(Real(3))).store(out.fused + i);
    neg_mul_add(a, b, Row(Real(3))).store(out.negated + i);
    (-a).store(out.opposite + i);
    const Row zero(Real(0));
    out.less |= bits(a < b) << i;
    out.at_most |= bits(a <= b) << i;
    out.both |= bits((a <= b) & (zero < a)) << i;
    out.either |= bits((a < b) | (zero < a)) << i;
    out.only_less |= bits(and_not(a <= b, zero < a)) << i;
    out.chosen |= bits(select(a < b, zero < a, zero < b)) << i;
    out.any_less |= any(a < b) ? 1U << i : 0U;
}

void compute_doubles(const Rows<double>& rows, Results<double>& out) {
    for (std::size_t i = 0; i < kCount; i += Doubles::kCount) {
        compute<Doubles>(rows, i, out);
    }
}

/// The products of complex numbers by i.
void turn(const double* pairs, double* out) {
    for (std::size_t i = 0; i < kCount; i += Doubles::kCount) {
        const ComplexDoubles z = ComplexDoubles::load_unaligned(pairs + 2 * i);
        ComplexDoubles{-z.im, z.re}.store_unaligned(out + 2 * i);
    }
}

void compute_float4(const Rows<float>& rows, Results<float>& out) {
    compute<Float4>(rows, 0, out);
    compute<Float4>(rows, 4, out);
}

void compute_float8(const Rows<float>& rows, Results<float>& out) {
    compute<Float8>(rows, 0, out);
}

/// Reads one number past the border of a cache line.
template <typename Row>
void interleave(const double* numbers, Interleaved& out) {
    for (std::size_t i = 0; i < kCount; i += Row::kCount) {
        const auto pair = load_pairs<Row>(numbers + 1 + 2 * i);
        pair.first.store(out.first + i);
        pair.second.store(out.second + i);
        reverse(pair.first).store(out.reversed + kCount - Row::kCount - i);
        store_pairs(pair.second, pair.first, out.pairs + 2 * i);
        store_fours(pair.first,
                    pair.second,
                    pair.first + pair.first,
                    pair.second + pair.second,
                    out.fours + 4 * i);
    }
}

void interleave_doubles(const double* numbers, Interleaved& out) {
    interleave<Doubles>(numbers, out);
}
void interleave_eight(const double* numbers, Interleaved& out) {
    interleave<Lanes<double, 8>>(numbers, out);
}
void interleave_one(const double* numbers, Interleaved& out) {
    interleave<Lanes<double, 1>>(numbers, out);
}

void shuffle(const float* numbers, Shuffles& out) {
    const Float8 all = Float8::load(numbers);
    const Float4 a = lower_half(all);
    const Float4 b = upper_half(all);
    a.store(out.low);
    b.store(out.high);
    swap_halves(all).store(out.swapped);
    rotate_by_one(a).store(out.by_one);
    rotate_by_two(a).store(out.by_two);
    interleave_lower(a, b).store(out.lower);
    interleave_upper(a, b).store(out.upper);
    alignas(16) const std::int32_t integers[4] = {0, -3, 16777215, 40};
    load_int32(integers).store(out.integers);
    const std::uint16_t shorts[8] = {0, 1, 2, 40000, 65535, 5, 6, 7};
    load_uint16(shorts).store(out.shorts);
    store_bits(all, out.bits);
    load_bits(out.bits).store(out.from_bits);
    store_masked_bits(a, 0xFFFF00, out.masked);
    for (std::size_t count = 0; count <= 8; ++count) {
        out.first[count] = bits(Float8::Mask::first(count));
    }
    out.smallest = reduce_min(all);
    out.largest = reduce_max(all);
    alignas(32) const std::uint32_t values[8] = {10, 11, 12, 13, 14, 15, 16, 17};
    // Lane r comes (7 - r)-th; of these all below 4 are kept.
    alignas(32) std::uint32_t order[8];
    for (std::uint32_t r = 0; r < 8; ++r) {
        order[r] = (7 - r) << 3U;
    }
    const Float8 far = select(all < Float8(4.0F), all, Float8(-10.0F));
    out.compressed = compress_ordered(all, far, values, order, 3, out.keys, out.values);
}

/// Compresses 0 ... 7 and 10 ... 17 by a mask given in bits.
std::size_t compress_by_bits(std::uint32_t mask, float* keys, std::uint32_t* values) {
    alignas(32) float numbers[8], is_kept[8];
    std::uint32_t words[8];
    for (std::uint32_t i = 0; i < 8; ++i) {
        numbers[i] = static_cast<float>(i);
        is_kept[i] = static_cast<float>(mask >> i & 1U);
        words[i] = 10 + i;
    }
    return compress(
        Float8::load(numbers), Float8(0.0F) < Float8::load(is_kept), words, keys, values);
}

/// Transposes eight rows of four numbers; row i holds 10 i ... 10 i + 3.
void transpose_rows(float* fours, double* threes) {
    double numbers[8][4];
    const double* rows[8];
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            numbers[i][k] = static_cast<double>(10 * i + k);
        }
        rows[i] = numbers[i];
    }
    Float8 columns[4];
    load_transposed(rows, columns);
    for (std::size_t k = 0; k < 4; ++k) {
        columns[k].store_unaligned(fours + 8 * k);
    }
    for (std::size_t i = 0; i < 8; i += Doubles::kCount) {
        Doubles part[3];
        load_transposed(rows + i, part);
        for (std::size_t k = 0; k < 3; ++k) {
            part[k].store_unaligned(threes + 8 * k + i);
        }
    }
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot {
namespace {

HWY_EXPORT(compute_doubles);
HWY_EXPORT(compute_float4);
HWY_EXPORT(compute_float8);
HWY_EXPORT(interleave_doubles);
HWY_EXPORT(interleave_eight);
HWY_EXPORT(interleave_one);
HWY_EXPORT(compress_by_bits);
HWY_EXPORT(transpose_rows);
HWY_EXPORT(shuffle);
HWY_EXPORT(turn);

template <typename Test>
void for_each_target(Test&& test) {
    for (const std::string& target : simd_targets()) {
        SCOPED_TRACE(target);
        override_simd_target(target);
        test();
    }
    override_simd_target("auto");
}

template <typename Real>
Rows<Real> some_rows() {
    const Real inf = std::numeric_limits<Real>::infinity();
    return {{Real(1.5), Real(-2), Real(3), Real(0.1), Real(-7), inf, Real(4), Real(1e-3)},
            {Real(2), Real(-2), Real(-5), Real(0.7), Real(3), Real(1), Real(-9), Real(1e3)}};
}

template <typename Real>
void expect_scalar_results(const Rows<Real>& rows, const Results<Real>& found) {
    for (std::size_t i = 0; i < kCount; ++i) {
        SCOPED_TRACE(i);
        const Real a = rows.a[i];
        const Real b = rows.b[i];
        const auto bit = [&](std::uint32_t mask) { return (mask >> i & 1U) != 0; };
        EXPECT_EQ(found.sum[i], a + b);
        EXPECT_EQ(found.difference[i], a - b);
        EXPECT_EQ(found.product[i], a * b);
        EXPECT_EQ(found.quotient[i], a / b);
        EXPECT_EQ(found.smaller[i], std::fmin(a, b));
        EXPECT_EQ(found.larger[i], std::fmax(a, b));
        EXPECT_EQ(found.magnitude[i], std::fabs(a));
        EXPECT_EQ(found.selected[i], a < b ? a : Real(7));
        EXPECT_TRUE(found.fused[i] == a * b + 3 || found.fused[i] == std::fma(a, b, Real(3)));
        EXPECT_TRUE(found.negated[i] == 3 - a * b || found.negated[i] == std::fma(-a, b, Real(3)));
        EXPECT_EQ(found.opposite[i], -a);
        EXPECT_EQ(bit(found.less), a < b);
        EXPECT_EQ(bit(found.at_most), a <= b);
        EXPECT_EQ(bit(found.both), a <= b && a > 0);
        EXPECT_EQ(bit(found.either), a < b || a > 0);
        EXPECT_EQ(bit(found.only_less), a <= b && !(a > 0));
        EXPECT_EQ(bit(found.chosen), a < b ? a > 0 : b > 0);
    }
    EXPECT_NE(found.any_less, 0U);
}

TEST(SimdLanes, ComputeWhatScalarsDo) {
    for_each_target([] {
        const auto doubles = some_rows<double>();
        Results<double> wide{};
        HWY_DYNAMIC_DISPATCH(compute_doubles)(doubles, wide);
        expect_scalar_results(doubles, wide);
        const auto floats = some_rows<float>();
        Results<float> by_four{}, by_eight{};
        HWY_DYNAMIC_DISPATCH(compute_float4)(floats, by_four);
        expect_scalar_results(floats, by_four);
        HWY_DYNAMIC_DISPATCH(compute_float8)(floats, by_eight);
        expect_scalar_results(floats, by_eight);
    });
}

TEST(SimdLanes, PartComplexNumbers) {
    for_each_target([] {
        std::array<double, 2 * kCount> numbers{}, found{};
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            numbers[i] = static_cast<double>(i) + 0.5;
        }
        HWY_DYNAMIC_DISPATCH(turn)(numbers.data(), found.data());
        for (std::size_t i = 0; i < kCount; ++i) {
            EXPECT_EQ(found[2 * i], -numbers[2 * i + 1]);
            EXPECT_EQ(found[2 * i + 1], numbers[2 * i]);
        }
    });
}

TEST(SimdLanes, CompareFalseWithWhatIsNoNumber) {
    for_each_target([] {
        auto rows = some_rows<float>();
        rows.a[0] = rows.b[1] = std::numeric_limits<float>::quiet_NaN();
        Results<float> found{};
        HWY_DYNAMIC_DISPATCH(compute_float8)(rows, found);
        EXPECT_EQ(found.less & 3U, 0U);
        EXPECT_EQ(found.at_most & 3U, 0U);
    });
}

TEST(SimdLanes, MoveLanesAsNamed) {
    for_each_target([] {
        alignas(32) const float n[8] = {1.0F, 9.0F, -3.0F, 4.0F, 2.5F, 7.0F, 3.0F, 8.0F};
        Shuffles found{};
        HWY_DYNAMIC_DISPATCH(shuffle)(n, found);
        for (std::size_t i = 0; i < 4; ++i) {
            SCOPED_TRACE(i);
            EXPECT_EQ(found.low[i], n[i]);
            EXPECT_EQ(found.high[i], n[4 + i]);
            EXPECT_EQ(found.by_one[i], n[(i + 1) % 4]);
            EXPECT_EQ(found.by_two[i], n[(i + 2) % 4]);
            EXPECT_EQ(found.lower[i], n[i / 2 + 4 * (i % 2)]);
            EXPECT_EQ(found.upper[i], n[2 + i / 2 + 4 * (i % 2)]);
        }
        for (std::size_t i = 0; i < 8; ++i) {
            SCOPED_TRACE(i);
            EXPECT_EQ(found.swapped[i], n[(i + 4) % 8]);
            EXPECT_EQ(found.bits[i], std::bit_cast<std::uint32_t>(n[i]));
            EXPECT_EQ(found.from_bits[i], n[i]);
            EXPECT_EQ(found.first[i], (1U << i) - 1U);
        }
        EXPECT_EQ(found.first[8], 255U);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(found.masked[i], std::bit_cast<std::uint32_t>(n[i]) & 0xFFFF00U);
        }
        EXPECT_EQ(found.integers[1], -3.0F);
        EXPECT_EQ(found.integers[2], 16777215.0F);
        EXPECT_EQ(found.shorts[3], 40000.0F);
        EXPECT_EQ(found.shorts[4], 65535.0F);
        EXPECT_EQ(found.smallest, -3.0F);
        EXPECT_EQ(found.largest, 9.0F);
    });
}

void expect_interleaved(const std::array<double, 2 * kCount + 1>& n, const Interleaved& found) {
    for (std::size_t i = 0; i < kCount; ++i) {
        SCOPED_TRACE(i);
        const double first = n[1 + 2 * i];
        const double second = n[2 + 2 * i];
        EXPECT_EQ(found.first[i], first);
        EXPECT_EQ(found.second[i], second);
        EXPECT_EQ(found.reversed[kCount - 1 - i], first);
        EXPECT_EQ(found.pairs[2 * i], second);
        EXPECT_EQ(found.pairs[2 * i + 1], first);
        for (std::size_t row = 0; row < 4; ++row) {
            EXPECT_EQ(found.fours[4 * i + row],
                      (row % 2 == 0 ? first : second) * (row < 2 ? 1.0 : 2.0));
        }
    }
}

TEST(SimdLanes, ReadAndWritePairsAndFours) {
    std::array<double, 2 * kCount + 1> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = 0.5 + static_cast<double>(i * i);
    }
    for_each_target([&] {
        Interleaved found{};
        HWY_DYNAMIC_DISPATCH(interleave_doubles)(numbers.data(), found);
        expect_interleaved(numbers, found);
        found = {};
        HWY_DYNAMIC_DISPATCH(interleave_eight)(numbers.data(), found);
        expect_interleaved(numbers, found);
        found = {};
        HWY_DYNAMIC_DISPATCH(interleave_one)(numbers.data(), found);
        expect_interleaved(numbers, found);
    });
}

TEST(SimdLanes, CompressInTheGivenOrder) {
    for_each_target([] {
        alignas(32) const float n[8] = {1.0F, 9.0F, -3.0F, 4.0F, 2.5F, 7.0F, 3.0F, 8.0F};
        Shuffles found{};
        HWY_DYNAMIC_DISPATCH(shuffle)(n, found);
        ASSERT_EQ(found.compressed, 4U);
        const std::array<float, 4> keys = {3.0F, 2.5F, -3.0F, 1.0F};
        const std::array<std::uint32_t, 4> values = {16, 14, 12, 10};
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_EQ(found.keys[i], keys[i]);
            EXPECT_EQ(found.values[i], values[i]);
        }
    });
}

TEST(SimdLanes, CompressByEveryMask) {
    for_each_target([] {
        for (std::uint32_t mask = 0; mask < 256; ++mask) {
            std::array<float, 8> keys{};
            std::array<std::uint32_t, 8> values{};
            std::size_t count = 0;
            const std::size_t found =
                HWY_DYNAMIC_DISPATCH(compress_by_bits)(mask, keys.data(), values.data());
            for (std::uint32_t i = 0; i < 8; ++i) {
                if ((mask >> i & 1U) != 0) {
                    ASSERT_EQ(keys[count], static_cast<float>(i)) << mask;
                    ASSERT_EQ(values[count++], 10 + i) << mask;
                }
            }
            ASSERT_EQ(found, count);
        }
    });
}

TEST(SimdLanes, TransposeRows) {
    for_each_target([] {
        std::array<float, 32> fours{};
        std::array<double, 24> threes{};
        HWY_DYNAMIC_DISPATCH(transpose_rows)(fours.data(), threes.data());
        for (std::size_t i = 0; i < 8; ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_EQ(fours[8 * k + i], static_cast<float>(10 * i + k));
            }
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_EQ(threes[8 * k + i], static_cast<double>(10 * i + k));
            }
        }
    });
}

}  // namespace
}  // namespace earshot
#endif
