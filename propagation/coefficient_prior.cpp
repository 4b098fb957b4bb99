// SPDX-License-Identifier: MIT
#include "earshot/propagation/coefficient_prior.h"

#include "earshot/base/math.h"

#include <algorithm>

namespace earshot::propagation {

namespace {

constexpr double kShare = 0.45, kMinSpread = 0.01, kMaxSpread = 0.12;
// Where the share of the absorption meets the limits.
constexpr double kMinLimit = kMinSpread / kShare, kMaxLimit = kMaxSpread / kShare;

double absorption_spread(double absorption) {
    return std::clamp(kShare * absorption, kMinSpread, kMaxSpread);
}

// Logarithmic between the limits of the spread, and 0 at the upper limit.
double absorption_position(double absorption) {
    if (absorption >= kMaxLimit) {
        return (absorption - kMaxLimit) / kMaxSpread;
    }
    if (absorption >= kMinLimit) {
        return math::log(absorption / kMaxLimit) / kShare;
    }
    return math::log(kMinLimit / kMaxLimit) / kShare + (absorption - kMinLimit) / kMinSpread;
}

double absorption_at(double position) {
    if (position >= 0.0) {
        return kMaxLimit + position * kMaxSpread;
    }
    const double min_position = math::log(kMinLimit / kMaxLimit) / kShare;
    return position >= min_position ? kMaxLimit * math::exp(kShare * position)
                                    : kMinLimit + (position - min_position) * kMinSpread;
}

// Of the logit, of which 0 and 1 are infinitely far away.
constexpr double kScatteringSpread = 0.7, kNearest = 1e-6;

double scattering_position(double scattering) {
    const double inside = std::clamp(scattering, kNearest, 1.0 - kNearest);
    return math::log(inside / (1.0 - inside)) / kScatteringSpread;
}

double scattering_at(double position) {
    return 1.0 / (1.0 + math::exp(-kScatteringSpread * position));
}

}  // namespace

double coefficient_spread(Coefficient of, double value) noexcept {
    return of == Coefficient::absorption ? absorption_spread(value)
                                         : kScatteringSpread * value * (1.0 - value);
}

double to_spread_scale(Coefficient of, double value) noexcept {
    return of == Coefficient::absorption ? absorption_position(value) : scattering_position(value);
}

double from_spread_scale(Coefficient of, double position) noexcept {
    return of == Coefficient::absorption ? absorption_at(position) : scattering_at(position);
}

}  // namespace earshot::propagation
