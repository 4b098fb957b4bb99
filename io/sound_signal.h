// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/io/wav.h"

namespace earshot::io {

/// The channels of a sound. Precondition: its sample rate is a whole number, in hertz.
audio::Signal signal_of(const Sound& sound);

/// The interleaved samples of a signal. Precondition: it has channels, of one size.
Sound sound_of(const audio::Signal& signal);

}  // namespace earshot::io
