// SPDX-License-Identifier: MIT
#include "earshot/base/error_free.h"
#include "earshot/base/math.h"

#include <cmath>
#include <limits>

// The circular functions and their inverses. The polynomials, and the tables of atan, are those of
// fdlibm (k_sin.c, k_cos.c, s_atan.c, e_asin.c, e_acos.c, e_rem_pio2.c), of which its authors say:
//
//   Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
//   Developed at SunPro, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
//   distribute this software is freely granted, provided that this notice is preserved.

namespace earshot::math {
namespace {

constexpr DoublePair kHalfPi{1.57079632679489655800e+00, 6.12323399573676603587e-17};
constexpr double kPiLow = 1.2246467991473531772e-16;  // pi - kPi

/// x = quarter_turns * pi/2 + remainder, |remainder| at most about pi/4.
struct Reduced {
    int quadrant = 0;  ///< quarter turns modulo 4
    DoublePair remainder;
};

// Cody and Waite 1980: pi/2 as three numbers of 33 bits and a rest, 151 bits in all. Up to 2^17
// quarter turns the products with the first three are exact, and 151 bits leave the remainder
// accurate to its last bit however near x comes to a multiple of pi/2.
Reduced reduce(double x) noexcept {
    constexpr double kMaxReducedExactly = 1e5;
    constexpr double kTwoOverPi = 6.36619772367581382433e-01;
    constexpr double kPart1 = 1.57079632673412561417e+00;
    constexpr double kPart2 = 6.07710050630396597660e-11;
    constexpr double kPart3 = 2.02226624871116645580e-21;
    constexpr double kRest = 8.47842766036889956997e-32;
    if (std::abs(x) > kMaxReducedExactly) {
        x = std::fmod(x, 2.0 * kPi);  // exact, but modulo a rounded 2 pi
    }
    const double turns = std::floor(x * kTwoOverPi + 0.5);
    const DoublePair first = two_sum(x - turns * kPart1, -(turns * kPart2));
    const DoublePair second = two_sum(first.hi, -(turns * kPart3));
    const DoublePair remainder = fast_two_sum(second.hi, (first.lo + second.lo) - turns * kRest);
    return {static_cast<int>(turns) & 3, remainder};
}

double sin_of_remainder(DoublePair r) noexcept {
    const double z = r.hi * r.hi;
    const double cube = z * r.hi;
    const double p = 8.33333333332248946124e-03 +
                     z * (-1.98412698298579493134e-04 +
                          z * (2.75573137070700676789e-06 +
                               z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    constexpr double kSixth = -1.66666666666666324348e-01;
    return r.hi - ((z * (0.5 * r.lo - cube * p) - r.lo) - cube * kSixth);
}

double cos_of_remainder(DoublePair r) noexcept {
    const double z = r.hi * r.hi;
    const double p =
        z * (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const double half = 0.5 * z;
    const double w = 1.0 - half;
    return w + (((1.0 - w) - half) + (z * p - r.hi * r.lo));
}

/// sin(x + quadrant * pi/2) from the remainder of x.
double sin_in_quadrant(DoublePair r, int quadrant) noexcept {
    const double value = (quadrant & 1) != 0 ? cos_of_remainder(r) : sin_of_remainder(r);
    return (quadrant & 2) != 0 ? -value : value;
}

/// atan(x) - x as a multiple of x, |x| <= 7/16 or so.
double atan_series(double x) noexcept {
    const double z = x * x;
    const double w = z * z;
    const double even =
        z * (3.33333333333329318027e-01 +
             w * (1.42857142725034663711e-01 +
                  w * (9.09088713343650656196e-02 +
                       w * (6.66107313738753120669e-02 +
                            w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
    const double odd =
        w * (-1.99999999998764832476e-01 +
             w * (-1.11111104054623557880e-01 +
                  w * (-7.69187620504482999495e-02 +
                       w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
    return -(even + odd);
}

/// atan(x) = atan(anchor) + atan(difference), x >= 7/16.
struct AtanReduced {
    DoublePair anchor;  ///< the arc tangent of 0.5, 1, 1.5 or infinity
    double difference = 0.0;
};

AtanReduced reduce_atan(double x) noexcept {
    if (x < 0.6875) {
        return {{4.63647609000806093515e-01, 2.26987774529616870924e-17},
                (2.0 * x - 1.0) / (2.0 + x)};
    }
    if (x < 1.1875) {
        return {{7.85398163397448278999e-01, 3.06161699786838301793e-17}, (x - 1.0) / (x + 1.0)};
    }
    if (x < 2.4375) {
        return {{9.82793723247329054082e-01, 1.39033110312309984516e-17},
                (x - 1.5) / (1.0 + 1.5 * x)};
    }
    return {kHalfPi, -1.0 / x};
}

/// (asin(x) - x) / x as a function of x^2 <= 1/4.
double asin_series(double t) noexcept {
    const double p =
        t * (1.66666666666666657415e-01 +
             t * (-3.25565818622400915405e-01 +
                  t * (2.01212532134862925881e-01 +
                       t * (-4.00555345006794114027e-02 +
                            t * (7.91534994289814532176e-04 + t * 3.47933107596021167570e-05)))));
    const double q =
        1.0 + t * (-2.40339491173441421878e+00 +
                   t * (2.02094576023350569471e+00 +
                        t * (-6.88283971605453293030e-01 + t * 7.70381505559019352791e-02)));
    return p / q;
}

/// sqrt(z) as a pair, for 0 < z <= 1.
DoublePair sqrt_pair(double z) noexcept {
    const double root = std::sqrt(z);
    const DoublePair square = two_product(root, root);
    return {root, ((z - square.hi) - square.lo) / (2.0 * root)};
}

}  // namespace

double sin(double x) noexcept {
    if (!std::isfinite(x)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (std::abs(x) < 0x1p-27) {
        return x;  // keeps the sign of zero
    }
    const Reduced reduced = reduce(x);
    return sin_in_quadrant(reduced.remainder, reduced.quadrant);
}

double cos(double x) noexcept {
    if (!std::isfinite(x)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const Reduced reduced = reduce(x);
    return sin_in_quadrant(reduced.remainder, reduced.quadrant + 1);
}

double tan(double x) noexcept {
    return sin(x) / cos(x);
}

double atan(double x) noexcept {
    const double magnitude = std::abs(x);
    if (!(magnitude >= 0.4375)) {
        return magnitude < 0x1p-27 ? x : x + x * atan_series(x);
    }
    const AtanReduced reduced = reduce_atan(magnitude);
    const double d = reduced.difference;
    const double value = reduced.anchor.hi - ((-d * atan_series(d) - reduced.anchor.lo) - d);
    return x < 0.0 ? -value : value;
}

double atan2(double y, double x) noexcept {
    if (std::isnan(x) || std::isnan(y)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double up = std::abs(y);
    const double along = std::abs(x);
    double angle = 0.0;  // of (along, up), in the first quadrant
    if (std::isinf(up) && std::isinf(along)) {
        angle = atan(1.0);
    } else if (along == 0.0 && up > 0.0) {
        angle = kHalfPi.hi;
    } else if (up > 0.0) {
        angle = atan(up / along);
    }
    if (std::signbit(x)) {
        angle = kPi - (angle - kPiLow);
    }
    return std::copysign(angle, y);
}

double asin(double x) noexcept {
    const double magnitude = std::abs(x);
    if (!(magnitude <= 1.0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (magnitude < 0.5) {
        return magnitude < 0x1p-27 ? x : x + x * asin_series(x * x);
    }
    if (magnitude == 1.0) {
        return std::copysign(kHalfPi.hi, x);
    }
    // asin(x) = pi/2 - 2 asin(sqrt((1 - x) / 2)).
    const double z = 0.5 * (1.0 - magnitude);
    const DoublePair root = sqrt_pair(z);
    const DoublePair difference = two_sum(kHalfPi.hi, -2.0 * root.hi);
    const double rest = kHalfPi.lo - 2.0 * (root.lo + root.hi * asin_series(z));
    return std::copysign(difference.hi + (difference.lo + rest), x);
}

double acos(double x) noexcept {
    if (!(std::abs(x) <= 1.0)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (std::abs(x) < 0.5) {
        return kHalfPi.hi - (x - (kHalfPi.lo - x * asin_series(x * x)));
    }
    const double z = 0.5 * (1.0 - std::abs(x));
    if (z == 0.0) {
        return x > 0.0 ? 0.0 : kPi;
    }
    // acos(x) = 2 asin(sqrt((1 - x) / 2)), and pi minus that for the negative side.
    const DoublePair root = sqrt_pair(z);
    const double half = root.hi + (root.lo + root.hi * asin_series(z));
    return x > 0.0 ? 2.0 * half : kPi - (2.0 * half - kPiLow);
}

}  // namespace earshot::math
