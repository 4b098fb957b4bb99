// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstdint>

namespace earshot::propagation {

/// Coefficients of a material that a calibration can fit.
enum class Coefficient : std::uint8_t { absorption, scattering };

/// How far a coefficient of one construction varies in literature about a published value of its
/// octave, a standard deviation (docs/calibrate.md). Absorption: 0.45 of the value, 0.01 ... 0.12,
/// which is what rows of the library that describe the same construction, from different
/// laboratories and books, differ by. Scattering: 0.7 of the logit, a factor of two of small
/// values, as ranges of tables have it.
double coefficient_spread(Coefficient of, double value) noexcept;

/// A scale of the coefficient on which this spread is 1 everywhere: the integral of 1 / spread. Any
/// absorption; scattering in 0 ... 1.
double to_spread_scale(Coefficient of, double value) noexcept;
double from_spread_scale(Coefficient of, double position) noexcept;

/// What is known of a coefficient before it is measured: a normal distribution on the scale of
/// spreads.
struct CoefficientPrior {
    Coefficient of = Coefficient::absorption;
    double mean = 0.1;
    double deviation = 1.0;  ///< standard deviation in spreads; 0: known exactly

    /// The coefficient that many standard deviations above the mean; absorption is not limited to 0
    /// ... 1.
    double value_at(double deviations) const noexcept {
        return from_spread_scale(of, to_spread_scale(of, mean) + deviation * deviations);
    }
    /// And the other way round. Precondition: deviation > 0.
    double deviations_of(double value) const noexcept {
        return (to_spread_scale(of, value) - to_spread_scale(of, mean)) / deviation;
    }
    /// Change of the coefficient per standard deviation.
    double rate_at(double value) const noexcept {
        return deviation * coefficient_spread(of, value);
    }
};

/// The deviation of a coefficient of which nothing is known: an absorption of 0.1 may turn out as
/// 0.03 or 0.37, and twice as far off as 0.01 or 0.7.
inline constexpr double kUnknownDeviation = 3.0;

}  // namespace earshot::propagation
