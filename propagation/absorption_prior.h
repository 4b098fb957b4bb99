// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

namespace earshot::propagation {

/// How far the absorption of one construction varies in literature about a published value of its
/// octave, a standard deviation: 0.45 of the value, 0.01 ... 0.12. That is what rows of the library
/// that describe the same construction, from different laboratories and books, differ by
/// (docs/calibrate.md).
double absorption_spread(double absorption) noexcept;

/// A scale of absorption on which this spread is 1 everywhere: the integral of 1 / spread,
/// logarithmic between the limits of the spread. Any absorption.
double to_spread_scale(double absorption) noexcept;
double from_spread_scale(double position) noexcept;

/// What is known of an absorption coefficient before it is measured: a normal distribution on the
/// scale of spreads.
struct AbsorptionPrior {
    double mean = 0.1;
    double deviation = 1.0;  ///< standard deviation in spreads; 0: known exactly

    /// The coefficient that many standard deviations above the mean, not limited to 0 ... 1.
    double absorption_at(double deviations) const noexcept {
        return from_spread_scale(to_spread_scale(mean) + deviation * deviations);
    }
    /// And the other way round. Precondition: deviation > 0.
    double deviations_of(double absorption) const noexcept {
        return (to_spread_scale(absorption) - to_spread_scale(mean)) / deviation;
    }
    /// Change of a coefficient per standard deviation.
    double rate_at(double absorption) const noexcept {
        return deviation * absorption_spread(absorption);
    }
};

/// The deviation of a coefficient of which nothing is known: 0.1 may turn out as 0.03 or 0.37, and
/// twice as far off as 0.01 or 0.7.
inline constexpr double kUnknownAbsorptionDeviation = 3.0;

}  // namespace earshot::propagation
