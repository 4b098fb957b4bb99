// SPDX-License-Identifier: MIT
#include "earshot/propagation/uniform_diffraction.h"

#include "earshot/base/assert.h"
#include "earshot/propagation/internal/complex_math.h"

#include <cmath>

namespace earshot::propagation {
namespace {

const double kRootPi = std::sqrt(math::kPi);

/// e^{j pi / 4}.
const Complex kEighthTurn{std::sqrt(0.5), std::sqrt(0.5)};

/// erfcx(e^{j pi / 4} x), x >= 0: the Taylor series of erf for small x, Laplace's continued
/// fraction for large x. Both are within 1e-12 where they are used.
Complex scaled_erfc(double x) noexcept {
    const Complex z = kEighthTurn * x;
    if (x < 2.5) {
        // erf z = 2 / sqrt(pi) e^{-z^2} sum (2 z^2)^n z / (1 3 5 ... (2n + 1)).
        Complex term = z;
        Complex sum = z;
        for (int n = 1; n < 80; ++n) {
            term *= 2.0 * z * z / (2.0 * n + 1.0);
            sum += term;
        }
        return unit(x * x) - 2.0 / kRootPi * sum;
    }
    Complex fraction = z;
    for (int n = 120; n > 0; --n) {
        fraction = z + 0.5 * n / fraction;
    }
    return 1.0 / (kRootPi * fraction);
}

/// Kouyoumjian and Pathak 1974, equation 27: F(X) = 2 j sqrt(X) e^{jX} int_{sqrt X}^inf e^{-j t^2}
/// dt.
Complex transition(double x) noexcept {
    const double root = std::sqrt(x);
    return kRootPi * root * kEighthTurn * scaled_erfc(root);
}

/// cot((pi + sign b) / 2n) F(k L a), equation 25. At a zone boundary the cotangent is infinite and
/// F is 0: there their product's limit is used.
Complex cotangent_term(double n, double b, double sign, double k_distance) noexcept {
    const double turns = std::nearbyint((b + sign * math::kPi) / (2.0 * math::kPi * n));
    const double cosine = math::cos(0.5 * (2.0 * math::kPi * n * turns - b));
    const double argument = 0.5 * (math::kPi + sign * b) / n;
    const double from_pole = argument - math::kPi * std::nearbyint(argument / math::kPi);
    const double x = 2.0 * n * from_pole;
    constexpr double kNearPole = 1e-5;  // where the limit is within 1e-10 of the product
    if (std::abs(x) < kNearPole) {
        const double root = std::sqrt(2.0 * math::kPi * k_distance);
        return n * kEighthTurn * (std::copysign(root, x) - 2.0 * k_distance * x * kEighthTurn);
    }
    return transition(k_distance * 2.0 * cosine * cosine) / math::tan(argument);
}

}  // namespace

std::complex<double> utd_coefficient(double open_angle,
                                     double source_angle,
                                     double listener_angle,
                                     double skew_sine,
                                     double distance,
                                     double wave_number) noexcept {
    EARSHOT_ASSERT(wave_number > 0.0);
    const double n = open_angle / math::kPi;
    Complex sum{0.0};
    for (const double b : {listener_angle - source_angle, listener_angle + source_angle}) {
        sum += cotangent_term(n, b, 1.0, wave_number * distance) +
               cotangent_term(n, b, -1.0, wave_number * distance);
    }
    const double scale = 2.0 * n * std::sqrt(2.0 * math::kPi * wave_number) * skew_sine;
    return -std::conj(kEighthTurn) / scale * sum;
}

std::complex<double> utd_pressure(const EdgeDiffraction& edge, double wave_number) noexcept {
    const double radii = edge.source.radius + edge.listener.radius;
    const double rise = edge.listener.z - edge.source.z;
    const double length = std::sqrt(radii * radii + rise * rise);
    // Both legs meet the edge under one angle at the apex.
    const double skew_sine = radii / length;
    const double before = edge.source.radius / skew_sine;
    const double after = edge.listener.radius / skew_sine;
    const Complex coefficient = utd_coefficient(edge.open_angle,
                                                edge.source.angle,
                                                edge.listener.angle,
                                                skew_sine,
                                                before * after * skew_sine * skew_sine / length,
                                                wave_number);
    return coefficient * unit(-wave_number * length) / std::sqrt(before * after * length);
}

}  // namespace earshot::propagation
