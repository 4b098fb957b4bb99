// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/fft.h"

#include <complex>
#include <span>
#include <vector>

namespace earshot::audio {

/// The phase, at the bins of `fft`, of the minimum-phase filter whose log-magnitude (natural
/// logarithm, real, at the same bins) is given: the real cepstrum folded onto positive times
/// (Oppenheim and Schafer 2010, section 13.5.4).
std::vector<double> minimum_phase(const RealFft& fft,
                                  std::span<const std::complex<double>> log_magnitude);

}  // namespace earshot::audio
