// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"

#include "earshot/base/error_free.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

// The exponential family: logarithms as pairs of doubles, so that one rounding makes each result,
// and powers as exp(y log x) on such a pair. The circular functions are in math_circular.cpp.

namespace earshot::math {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Constants to 106 bits: the nearest double, and the nearest double to what is left.
constexpr DoublePair kLn2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
constexpr DoublePair kLn10{0x1.26bb1bbb55516p+1, -0x1.f48ad494ea3e9p-53};
constexpr DoublePair kOverLn2{0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};
constexpr DoublePair kOverLn10{0x1.bcb7b1526e50ep-2, 0x1.95355baaafad3p-57};

DoublePair add(DoublePair a, DoublePair b) noexcept {
    const DoublePair sum = two_sum(a.hi, b.hi);
    return fast_two_sum(sum.hi, sum.lo + (a.lo + b.lo));
}

DoublePair multiply(DoublePair a, DoublePair b) noexcept {
    const DoublePair product = two_product(a.hi, b.hi);
    return fast_two_sum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

/// 2^k for -1022 <= k <= 1023.
double power_of_two(int k) noexcept {
    return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
}

/// A positive finite number as 2^exponent * mantissa, sqrt(1/2) <= mantissa < sqrt(2).
struct Scaled {
    int exponent = 0;
    double mantissa = 1.0;
};

Scaled scaled(double x) noexcept {
    constexpr double kSqrtHalf = 0x1.6a09e667f3bcdp-1;
    Scaled result;
    result.mantissa = std::frexp(x, &result.exponent);
    if (result.mantissa < kSqrtHalf) {
        result.mantissa *= 2.0;
        --result.exponent;
    }
    return result;
}

/// log(m) to about 2^-68 relative, sqrt(1/2) <= m < sqrt(2).
DoublePair log_of_mantissa(double m) noexcept {
    // s = (m - 1) / (m + 1); m - 1 is exact (Sterbenz 1974).
    const double numerator = m - 1.0;
    const DoublePair denominator = two_sum(m, 1.0);
    const double quotient = numerator / denominator.hi;
    const DoublePair back = two_product(quotient, denominator.hi);
    const double remainder = ((numerator - back.hi) - back.lo) - quotient * denominator.lo;
    const DoublePair s = fast_two_sum(quotient, remainder / denominator.hi);

    // log m = 2 s (1 + s^2/3 + s^4/5 + ...), s^2 < 2^-5. The terms from s^8/9 on are below 2^-23 of
    // the sum, so a double is enough for them; s^28/29 and later are below 2^-75.
    const DoublePair square = multiply(s, s);
    const double z = square.hi;
    double tail = 1.0 / 27.0;
    for (int odd = 25; odd >= 9; odd -= 2) {
        tail = tail * z + 1.0 / static_cast<double>(odd);
    }
    constexpr DoublePair kThird{0x1.5555555555555p-2, 0x1.5555555555555p-56};
    constexpr DoublePair kFifth{0x1.999999999999ap-3, -0x1.999999999999ap-57};
    constexpr DoublePair kSeventh{0x1.2492492492492p-3, 0x1.2492492492492p-57};
    DoublePair sum = add(kSeventh, {z * tail, 0.0});
    sum = add(kFifth, multiply(square, sum));
    sum = add(kThird, multiply(square, sum));
    sum = add({1.0, 0.0}, multiply(square, sum));
    return multiply({2.0 * s.hi, 2.0 * s.lo}, sum);
}

/// log(x) as a pair, x positive and finite.
DoublePair log_pair(double x) noexcept {
    const Scaled parts = scaled(x);
    const double k = parts.exponent;
    return add(multiply({k, 0.0}, kLn2), log_of_mantissa(parts.mantissa));
}

/// True where a logarithm is not a finite number; then `value` is what it is.
struct Limit {
    bool reached = false;
    double value = 0.0;
};

Limit log_limit(double x) noexcept {
    if (x > 0.0 && x < kInfinity) {
        return {};
    }
    if (x == 0.0) {
        return {true, -kInfinity};
    }
    return {true, x < 0.0 ? kNan : x};
}

/// exp(hi + lo), |lo| at most about an ulp of hi. fdlibm's e_exp.c, which reduces to such a sum
/// anyway.
double exp_of_sum(double hi, double lo) noexcept {
    constexpr double kOverflow = 7.09782712893383973096e+02;
    constexpr double kUnderflow = -7.45133219101941108420e+02;
    if (!(hi <= kOverflow)) {
        return hi > kOverflow ? kInfinity : hi;
    }
    if (hi < kUnderflow) {
        return 0.0;
    }
    // hi + lo = k ln 2 + r. kLn2Hi has 21 trailing zero bits, so k * kLn2Hi is exact.
    constexpr double kLn2Hi = 6.93147180369123816490e-01;
    constexpr double kLn2Lo = 1.90821492927058770002e-10;
    const double k = std::floor(hi * kOverLn2.hi + 0.5);
    const double r_hi = hi - k * kLn2Hi;
    const double r_lo = k * kLn2Lo - lo;
    const double r = r_hi - r_lo;

    // exp(r) = 1 + r + r c / (2 - c) with a polynomial for c.
    const double t = r * r;
    const double c =
        r - t * (1.66666666666666019037e-01 +
                 t * (-2.77777777770155933842e-03 +
                      t * (6.61375632143793436117e-05 +
                           t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
    const double y = 1.0 - ((r_lo - (r * c) / (2.0 - c)) - r_hi);

    // In two steps, because 2^k itself may overflow or underflow; only the last one rounds.
    const int exponent = static_cast<int>(k);
    const int half = exponent / 2;
    return y * power_of_two(half) * power_of_two(exponent - half);
}

/// pow for 0 < x < infinity, x != 1, y finite and not 0.
double pow_of_finite(double x, double y) noexcept {
    // Beyond these the result is 0 or infinite whatever the rounding; within them |y| < 2^63.
    constexpr double kFar = 800.0;
    const DoublePair log_x = log_pair(x);
    const double estimate = y * log_x.hi;
    if (estimate > kFar) {
        return kInfinity;
    }
    if (estimate < -kFar) {
        return 0.0;
    }
    const DoublePair exponent = multiply({y, 0.0}, log_x);
    return exp_of_sum(exponent.hi, exponent.lo);
}

}  // namespace

double exp(double x) noexcept {
    return exp_of_sum(x, 0.0);
}

double log(double x) noexcept {
    const Limit limit = log_limit(x);
    return limit.reached ? limit.value : log_pair(x).hi;
}

double log2(double x) noexcept {
    const Limit limit = log_limit(x);
    if (limit.reached) {
        return limit.value;
    }
    const Scaled parts = scaled(x);
    const double k = parts.exponent;
    return add({k, 0.0}, multiply(log_of_mantissa(parts.mantissa), kOverLn2)).hi;
}

double log10(double x) noexcept {
    const Limit limit = log_limit(x);
    return limit.reached ? limit.value : multiply(log_pair(x), kOverLn10).hi;
}

double pow10(double x) noexcept {
    constexpr double kLargestExact = 22.0;  // 10^22 is the largest power of ten that is a double
    constexpr double kFar = 400.0;          // 10^x is 0 or infinite beyond, whatever the rounding
    if (x >= 0.0 && x <= kLargestExact && x == std::floor(x)) {
        double power = 1.0;
        for (int n = static_cast<int>(x); n > 0; --n) {
            power *= 10.0;
        }
        return power;
    }
    if (!(x > -kFar && x < kFar)) {
        return exp_of_sum(x * kLn10.hi, 0.0);
    }
    const DoublePair exponent = multiply({x, 0.0}, kLn10);
    return exp_of_sum(exponent.hi, exponent.lo);
}

double pow(double x, double y) noexcept {
    if (y == 0.0 || x == 1.0) {
        return 1.0;
    }
    if (std::isnan(x) || std::isnan(y)) {
        return kNan;
    }
    if (x < 0.0) {
        return kNan;
    }
    if (std::isinf(y)) {
        return (x > 1.0) == (y > 0.0) ? kInfinity : 0.0;
    }
    if (x == 0.0 || std::isinf(x)) {
        return (x > 1.0) == (y > 0.0) ? kInfinity : 0.0;
    }
    return pow_of_finite(x, y);
}

}  // namespace earshot::math
