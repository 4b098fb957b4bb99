// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

namespace earshot {

/// An unevaluated sum hi + lo with |lo| at most half an ulp of hi: about 106 bits.
struct DoublePair {
    double hi = 0.0;
    double lo = 0.0;
};

// Error-free transformations: the pair equals the exact result. They need neither fused
// multiply-add nor a rounding mode other than to nearest, and hold as long as nothing overflows
// and no error term underflows.

/// a + b (Knuth 1969, theorem B; any order of magnitudes).
inline DoublePair two_sum(double a, double b) noexcept {
    const double sum = a + b;
    const double b_part = sum - a;
    const double a_part = sum - b_part;
    return {sum, (a - a_part) + (b - b_part)};
}

/// a + b, given |a| >= |b| or a == 0 (Dekker 1971).
inline DoublePair fast_two_sum(double a, double b) noexcept {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

/// a as a sum of two numbers of at most 26 bits (Veltkamp 1968). |a| < 2^996.
inline DoublePair split(double a) noexcept {
    constexpr double kSplitter = 0x1p27 + 1.0;
    const double scaled = kSplitter * a;
    const double hi = scaled - (scaled - a);
    return {hi, a - hi};
}

/// a * b (Dekker 1971). |a|, |b| < 2^996.
inline DoublePair two_product(double a, double b) noexcept {
    const double product = a * b;
    const DoublePair x = split(a);
    const DoublePair y = split(b);
    const double error = ((x.hi * y.hi - product) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo;
    return {product, error};
}

}  // namespace earshot
