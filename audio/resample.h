// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::audio {

/// A signal at another sample rate, ceil(size * to / from) samples from the same instant on: the
/// values of the band-limited signal that the samples are taken from. What lies between 0.95 and
/// 1.05 of half the lower rate is attenuated or aliased in part (the impulse of
/// internal/fractional_delay.h); all else is right within 2.5e-5. The same bits on any machine. An
/// impulse response taken for a filter needs the factor from / to besides. Precondition: rates in
/// hertz, 1 ... 2^31 - 1.
std::vector<double> resample(std::span<const double> signal,
                             std::int64_t from_hz,
                             std::int64_t to_hz);

}  // namespace earshot::audio
