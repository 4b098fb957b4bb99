// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

namespace earshot::math {

// Transcendental functions whose results reach output files. glibc picks variants with or without
// fused multiply-add at run time and these differ in the last bit; the ones below use only +, -, *,
// /, sqrt and other operations that IEEE 754 defines to the last bit, in a fixed order, so they
// give the same bits on every x86-64 CPU. Errors are against the true value, an ulp being the
// spacing of doubles there; the bounds are those that tests/base/math_test.cpp checks. NaN in gives
// NaN out.
//
// Logarithms and powers are computed on pairs of doubles; the other polynomials and reductions are
// those of fdlibm (Sun Microsystems 1993; see docs/references.md).

inline constexpr double kPi = 3.14159265358979323846;

double exp(double x) noexcept;    ///< within 1 ulp
double log(double x) noexcept;    ///< natural logarithm, 0.51 ulp; -infinity at 0, NaN below
double log2(double x) noexcept;   ///< within 0.51 ulp; exact for powers of two
double log10(double x) noexcept;  ///< within 0.51 ulp; exact for 1, 10, ... 10^22
double pow10(double x) noexcept;  ///< 10^x, within 1 ulp; exact for x = 0, 1, ... 22

/// x^y for x >= 0, within 1 ulp. NaN for any x < 0, whole y or not; pow(x, 0) and pow(1, y) are 1
/// even where the other argument is NaN.
double pow(double x, double y) noexcept;

double sin(double x) noexcept;  ///< within 1 ulp for |x| <= 1e5 radians; see cos
/// Within 1 ulp for |x| <= 1e5 radians. Beyond, x is reduced modulo the double nearest to 2 pi: the
/// error grows as 4e-17 |x|. NaN at the infinities.
double cos(double x) noexcept;
double tan(double x) noexcept;   ///< sin / cos, within 2 ulp
double atan(double x) noexcept;  ///< within 1 ulp

/// The angle of (x, y), within 2 ulp; zeros, infinities and signs as std::atan2.
double atan2(double y, double x) noexcept;
double asin(double x) noexcept;  ///< within 1 ulp; NaN outside [-1, 1]
double acos(double x) noexcept;  ///< within 1 ulp; NaN outside [-1, 1]

}  // namespace earshot::math
