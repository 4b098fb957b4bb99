// SPDX-License-Identifier: MIT
#pragma once

namespace earshot::math {

// Transcendental functions whose results reach output files. glibc picks variants with or without
// fused multiply-add at run time and these differ in the last bit; the ones below use only +, -, *,
// / and sqrt in a fixed order, so they give the same bits on every x86-64 CPU. Within 1 ulp of the
// true value unless stated otherwise. NaN in gives NaN out.
//
// The polynomials and the reductions are those of fdlibm (Sun Microsystems 1993; see
// docs/references.md).

inline constexpr double kPi = 3.14159265358979323846;

double exp(double x) noexcept;
double log(double x) noexcept;    ///< natural logarithm; -infinity at 0, NaN below
double log2(double x) noexcept;   ///< exact for powers of two; within 2 ulp
double log10(double x) noexcept;  ///< within 2 ulp
double pow10(double x) noexcept;  ///< 10^x, within 2 ulp for |x| <= 20
double pow(double x,
           double y) noexcept;  ///< x^y for x >= 0, within 1e-14 relative for |y log x| <= 50
double sin(double x) noexcept;  ///< |x| <= 1e5 radians; larger arguments lose accuracy
double cos(double x) noexcept;  ///< as sin
double tan(double x) noexcept;  ///< sin / cos, within 2 ulp
double atan(double x) noexcept;
double atan2(double y, double x) noexcept;  ///< as std::atan2, signed zeros included
double asin(double x) noexcept;             ///< within 2 ulp; NaN outside [-1, 1]
double acos(double x) noexcept;             ///< within 2 ulp; NaN outside [-1, 1]

}  // namespace earshot::math
