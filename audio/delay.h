// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <span>
#include <vector>

namespace earshot::audio {

/// The signal later by `delay` samples, longer by that and, if the delay is no whole number, by the
/// 64 samples in which band-limited interpolation rings (docs/algorithms/audio.md). Whole delays
/// keep every sample; what would ring before the first sample is left out. Precondition: delay is
/// finite and not negative.
std::vector<double> delayed(std::span<const double> samples, double delay);

}  // namespace earshot::audio
