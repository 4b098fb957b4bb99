// SPDX-License-Identifier: MIT
//
// exp, pow10, log, sin and cos of doubles side by side, with the bits of the functions of
// base/math.h: the same steps on lanes, with selections in place of branches. See lanes-inl.h for
// what an -inl.h is; base/math.cpp and base/math_circular.cpp say where the numbers come from.

#include "earshot/base/simd/lanes-inl.h"

#include <cstddef>
#include <limits>

#if defined(EARSHOT_BASE_SIMD_MATH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_SIMD_MATH_INL_H
#undef EARSHOT_BASE_SIMD_MATH_INL_H
#else
#define EARSHOT_BASE_SIMD_MATH_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

/// The largest whole number that is not above each lane.
HWY_INLINE Doubles floor(Doubles a) {
    return map<Doubles>([](auto v) { return hn::Floor(v); }, a);
}

HWY_INLINE Doubles sqrt(Doubles a) {
    return map<Doubles>([](auto v) { return hn::Sqrt(v); }, a);
}

/// The bits of each lane as unsigned numbers, changed by `operation`.
template <typename Operation>
HWY_INLINE Doubles with_bits(Doubles a, const Operation& operation) {
    return map<Doubles>(
        [&](auto v) {
            const hn::RebindToUnsigned<Doubles::Tag> tag;
            return hn::BitCast(Doubles::Tag(), operation(tag, hn::BitCast(tag, v)));
        },
        a);
}

/// Whole numbers of less than 2^51 whose two's complement is in the lowest bits.
HWY_INLINE Doubles integers_in_bits(Doubles whole) {
    return whole + Doubles(0x1.8p52);
}

/// 2^k for whole numbers -1022 <= k <= 1023.
HWY_INLINE Doubles power_of_two(Doubles k) {
    return with_bits(integers_in_bits(k), [](auto tag, auto bits) {
        return hn::ShiftLeft<52>(hn::Add(bits, hn::Set(tag, 1023)));
    });
}

/// Whether a bit of whole numbers is set.
template <int kBit>
HWY_INLINE Doubles::Mask has_bit(Doubles whole) {
    return map<Doubles::Mask>(
        [](auto v) {
            const hn::RebindToUnsigned<Doubles::Tag> tag;
            const auto bits = hn::BitCast(tag, v);
            return hn::RebindMask(Doubles::Tag(), hn::TestBit(bits, hn::Set(tag, 1ULL << kBit)));
        },
        integers_in_bits(whole));
}

/// DoublePair of base/error_free.h, and its sums and products.
struct DoublesPair {
    Doubles hi, lo;
};

HWY_INLINE DoublesPair two_sum(Doubles a, Doubles b) {
    const Doubles sum = a + b;
    const Doubles b_part = sum - a;
    const Doubles a_part = sum - b_part;
    return {sum, (a - a_part) + (b - b_part)};
}

HWY_INLINE DoublesPair fast_two_sum(Doubles a, Doubles b) {
    const Doubles sum = a + b;
    return {sum, b - (sum - a)};
}

HWY_INLINE DoublesPair split(Doubles a) {
    const Doubles scaled = Doubles(0x1p27 + 1.0) * a;
    const Doubles hi = scaled - (scaled - a);
    return {hi, a - hi};
}

HWY_INLINE DoublesPair two_product(Doubles a, Doubles b) {
    const Doubles product = a * b;
    const DoublesPair x = split(a);
    const DoublesPair y = split(b);
    const Doubles error = ((x.hi * y.hi - product) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo;
    return {product, error};
}

HWY_INLINE DoublesPair add(DoublesPair a, DoublesPair b) {
    const DoublesPair sum = two_sum(a.hi, b.hi);
    return fast_two_sum(sum.hi, sum.lo + (a.lo + b.lo));
}

HWY_INLINE DoublesPair multiply(DoublesPair a, DoublesPair b) {
    const DoublesPair product = two_product(a.hi, b.hi);
    return fast_two_sum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

HWY_INLINE DoublesPair pair_of(double hi, double lo) {
    return {Doubles(hi), Doubles(lo)};
}

/// c[0] + x (c[1] + x (c[2] + ...)), as math.cpp writes it out.
template <std::size_t N>
HWY_INLINE Doubles polynomial(Doubles x, const double (&c)[N]) {
    Doubles sum = Doubles(c[N - 1]);
    for (std::size_t k = N - 1; k > 0; --k) {
        sum = Doubles(c[k - 1]) + x * sum;
    }
    return sum;
}

/// exp(x + lo), where lo is to x as its rounding.
HWY_INLINE Doubles exp_of_sum(Doubles x, Doubles lo) {
    constexpr double kCoefficients[] = {1.66666666666666019037e-01,
                                        -2.77777777770155933842e-03,
                                        6.61375632143793436117e-05,
                                        -1.65339022054652515390e-06,
                                        4.13813679705723846039e-08};
    const Doubles k = floor(x * Doubles(0x1.71547652b82fep+0) + Doubles(0.5));
    const Doubles r_hi = x - k * Doubles(6.93147180369123816490e-01);
    const Doubles r_lo = k * Doubles(1.90821492927058770002e-10) - lo;
    const Doubles r = r_hi - r_lo;
    const Doubles t = r * r;
    const Doubles c = r - t * polynomial(t, kCoefficients);
    const Doubles y = Doubles(1.0) - ((r_lo - (r * c) / (Doubles(2.0) - c)) - r_hi);
    // In two steps, because 2^k itself may overflow or underflow; only the last one rounds.
    const Doubles half = floor(k * Doubles(0.5));
    Doubles result = y * power_of_two(half) * power_of_two(k - half);

    const Doubles overflow(7.09782712893383973096e+02);
    const Doubles infinity(std::numeric_limits<double>::infinity());
    result = select(x < Doubles(-7.45133219101941108420e+02), Doubles(0.0), result);
    return select(x <= overflow, result, select(overflow < x, infinity, x));
}

/// math::exp().
HWY_INLINE Doubles exp(Doubles x) {
    return exp_of_sum(x, Doubles(0.0));
}

/// math::pow10() of finite numbers that are not above 0, of which it makes no special case.
HWY_INLINE Doubles pow10(Doubles x) {
    const DoublesPair ln10 = pair_of(0x1.26bb1bbb55516p+1, -0x1.f48ad494ea3e9p-53);
    const DoublesPair exponent = multiply({x, Doubles(0.0)}, ln10);
    return exp_of_sum(exponent.hi, exponent.lo);
}

/// log(m) to about 2^-68 relative, sqrt(1/2) <= m < sqrt(2).
HWY_INLINE DoublesPair log_of_mantissa(Doubles m) {
    const Doubles numerator = m - Doubles(1.0);
    const DoublesPair denominator = two_sum(m, Doubles(1.0));
    const Doubles quotient = numerator / denominator.hi;
    const DoublesPair back = two_product(quotient, denominator.hi);
    const Doubles remainder = ((numerator - back.hi) - back.lo) - quotient * denominator.lo;
    const DoublesPair s = fast_two_sum(quotient, remainder / denominator.hi);

    const DoublesPair square = multiply(s, s);
    const Doubles z = square.hi;
    Doubles tail(1.0 / 27.0);
    for (int odd = 25; odd >= 9; odd -= 2) {
        tail = tail * z + Doubles(1.0 / static_cast<double>(odd));
    }
    DoublesPair sum =
        add(pair_of(0x1.2492492492492p-3, 0x1.2492492492492p-57), {z * tail, Doubles(0.0)});
    sum = add(pair_of(0x1.999999999999ap-3, -0x1.999999999999ap-57), multiply(square, sum));
    sum = add(pair_of(0x1.5555555555555p-2, 0x1.5555555555555p-56), multiply(square, sum));
    sum = add(pair_of(1.0, 0.0), multiply(square, sum));
    return multiply({Doubles(2.0) * s.hi, Doubles(2.0) * s.lo}, sum);
}

/// math::log().
HWY_INLINE Doubles log(Doubles x) {
    // x = 2^exponent * mantissa; subnormal numbers are made normal first.
    const Doubles::Mask subnormal = x < Doubles(0x1p-1022);
    const Doubles normal = select(subnormal, x * Doubles(0x1p54), x);
    Doubles mantissa = with_bits(normal, [](auto tag, auto bits) {
        return hn::Or(hn::And(bits, hn::Set(tag, 0x000fffffffffffffULL)),
                      hn::Set(tag, 0x3fe0000000000000ULL));
    });
    Doubles exponent = with_bits(normal, [](auto tag, auto bits) {
        return hn::Or(hn::ShiftRight<52>(bits), hn::Set(tag, 0x4330000000000000ULL));
    });
    exponent = exponent - Doubles(0x1p52 + 1022.0);
    exponent = select(subnormal, exponent - Doubles(54.0), exponent);
    const Doubles::Mask low = mantissa < Doubles(0x1.6a09e667f3bcdp-1);
    mantissa = select(low, mantissa * Doubles(2.0), mantissa);
    exponent = select(low, exponent - Doubles(1.0), exponent);

    const DoublesPair ln2 = pair_of(0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56);
    const DoublesPair of_exponent = multiply({exponent, Doubles(0.0)}, ln2);
    const Doubles result = add(of_exponent, log_of_mantissa(mantissa)).hi;

    const Doubles infinity(std::numeric_limits<double>::infinity());
    const Doubles nan(std::numeric_limits<double>::quiet_NaN());
    const Doubles at_zero = select(x < Doubles(0.0), nan, -infinity);
    // Infinity and what is no number are their own logarithms.
    return select(x < infinity, select(Doubles(0.0) < x, result, at_zero), x);
}

struct SinCos {
    Doubles sin, cos;
};

/// math::sin() and math::cos(), for |x| <= 1e5.
HWY_INLINE SinCos sin_cos(Doubles x) {
    const Doubles turns = floor(x * Doubles(6.36619772367581382433e-01) + Doubles(0.5));
    const DoublesPair first = two_sum(x - turns * Doubles(1.57079632673412561417e+00),
                                      -(turns * Doubles(6.07710050630396597660e-11)));
    const DoublesPair second = two_sum(first.hi, -(turns * Doubles(2.02226624871116645580e-21)));
    const DoublesPair r = fast_two_sum(
        second.hi, (first.lo + second.lo) - turns * Doubles(8.47842766036889956997e-32));
    const Doubles z = r.hi * r.hi;

    constexpr double kSine[] = {8.33333333332248946124e-03,
                                -1.98412698298579493134e-04,
                                2.75573137070700676789e-06,
                                -2.50507602534068634195e-08,
                                1.58969099521155010221e-10};
    const Doubles cube = z * r.hi;
    const Doubles sine_tail = z * (Doubles(0.5) * r.lo - cube * polynomial(z, kSine)) - r.lo;
    const Doubles sine = r.hi - (sine_tail - cube * Doubles(-1.66666666666666324348e-01));

    constexpr double kCosine[] = {4.16666666666666019037e-02,
                                  -1.38888888888741095749e-03,
                                  2.48015872894767294178e-05,
                                  -2.75573143513906633035e-07,
                                  2.08757232129817482790e-09,
                                  -1.13596475577881948265e-11};
    const Doubles half = Doubles(0.5) * z;
    const Doubles w = Doubles(1.0) - half;
    const Doubles p = z * polynomial(z, kCosine);
    const Doubles cosine = w + (((Doubles(1.0) - w) - half) + (z * p - r.hi * r.lo));

    // sin(x + quadrant * pi/2).
    const Doubles::Mask odd = has_bit<0>(turns);
    const Doubles::Mask half_turned = has_bit<1>(turns);
    const Doubles::Mask cos_half_turned = has_bit<1>(turns + Doubles(1.0));
    const Doubles of_sine = select(odd, cosine, sine);
    const Doubles of_cosine = select(odd, sine, cosine);
    const Doubles sin = select(half_turned, -of_sine, of_sine);
    return {select(abs(x) < Doubles(0x1p-27), x, sin),  // keeps the sign of zero
            select(cos_half_turned, -of_cosine, of_cosine)};
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
