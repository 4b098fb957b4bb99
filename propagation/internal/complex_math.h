// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"

#include <cmath>
#include <complex>

namespace earshot::propagation {

// Hyperbolic and complex functions with the same bits everywhere, built from base/math.h: those of
// the standard library differ between processors.

using Complex = std::complex<double>;

/// log(1 + x), also for small x. Kahan's device: the rounding of 1 + x cancels in the quotient.
inline double log1p(double x) noexcept {
    const double u = 1.0 + x;
    return u == 1.0 ? x : math::log(u) * (x / (u - 1.0));
}

inline double asinh(double x) noexcept {
    const double a = std::abs(x);
    return std::copysign(log1p(a + a * (a / (1.0 + std::sqrt(1.0 + a * a)))), x);
}

inline double sinh(double x) noexcept {
    if (std::abs(x) < 0.3) {
        // Taylor: the next term is below 1e-17 of the first.
        const double s = x * x;
        const double tail = 1.0 + s / 72.0 * (1.0 + s / 110.0 * (1.0 + s / 156.0));
        return x * (1.0 + s / 6.0 * (1.0 + s / 20.0 * (1.0 + s / 42.0 * tail)));
    }
    const double e = math::exp(x);
    return 0.5 * (e - 1.0 / e);
}

inline double tanh(double x) noexcept {
    const double a = std::abs(x);
    if (a > 20.0) {
        return std::copysign(1.0, x);
    }
    const double s = sinh(x);
    return s / std::sqrt(1.0 + s * s);
}

/// e^{j phase}.
inline Complex unit(double phase) noexcept {
    return {math::cos(phase), math::sin(phase)};
}

inline Complex exp(const Complex& z) noexcept {
    return math::exp(z.real()) * unit(z.imag());
}

/// Principal branch.
inline Complex log(const Complex& z) noexcept {
    return {0.5 * math::log(std::norm(z)), math::atan2(z.imag(), z.real())};
}

/// Principal branch. |z|^2 must neither overflow nor underflow.
inline Complex sqrt(const Complex& z) noexcept {
    const double size = std::sqrt(std::norm(z));
    if (size == 0.0) {
        return 0.0;
    }
    const double larger = std::sqrt(0.5 * (size + std::abs(z.real())));
    const double smaller = 0.5 * std::abs(z.imag()) / larger;
    return z.real() >= 0.0 ? Complex(larger, std::copysign(smaller, z.imag()))
                           : Complex(smaller, std::copysign(larger, z.imag()));
}

}  // namespace earshot::propagation
