// SPDX-License-Identifier: MIT
#include "earshot/propagation/absorption_prior.h"

#include "earshot/base/math.h"

#include <algorithm>

namespace earshot::propagation {

namespace {

constexpr double kShare = 0.45, kMinSpread = 0.01, kMaxSpread = 0.12;
// Where the share of the absorption meets the limits.
constexpr double kMinLimit = kMinSpread / kShare, kMaxLimit = kMaxSpread / kShare;

}  // namespace

double absorption_spread(double absorption) noexcept {
    return std::clamp(kShare * absorption, kMinSpread, kMaxSpread);
}

// 0 at the upper limit.
double to_spread_scale(double absorption) noexcept {
    if (absorption >= kMaxLimit) {
        return (absorption - kMaxLimit) / kMaxSpread;
    }
    if (absorption >= kMinLimit) {
        return math::log(absorption / kMaxLimit) / kShare;
    }
    return math::log(kMinLimit / kMaxLimit) / kShare + (absorption - kMinLimit) / kMinSpread;
}

double from_spread_scale(double position) noexcept {
    if (position >= 0.0) {
        return kMaxLimit + position * kMaxSpread;
    }
    const double min_position = math::log(kMinLimit / kMaxLimit) / kShare;
    return position >= min_position ? kMaxLimit * math::exp(kShare * position)
                                    : kMinLimit + (position - min_position) * kMinSpread;
}

}  // namespace earshot::propagation
