// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/energy_course.h"

#include <array>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// Derivatives of the speech transmission index by the energy of each octave in each of `steps`
/// steps of `step` seconds. Where the index or a modulation is at a limit, they are 0.
std::array<std::vector<double>, kSpeechBands> speech_gradient(const SpeechCourse& speech,
                                                              std::size_t steps,
                                                              double step);

}  // namespace earshot::audio
