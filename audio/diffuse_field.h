// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"

namespace earshot::audio {

/// The set with flat responses to a diffuse field: the power of both ears, averaged over the sphere
/// and smoothed over third octaves, becomes that of the pressure without a head. This takes out the
/// loudspeaker, the microphones and the ear canal, which every direction has in common, by a
/// minimum-phase filter. Below 150 Hz, where a head changes nothing but measurements of small rooms
/// and loudspeakers end, the magnitudes are 0 dB in every direction; to 300 Hz they pass over
/// into the measured ones. Delays stay as measured, centre_delay is set to common_delay(), and
/// the responses are at most kEqualisedLength long.
HrirSet diffuse_field_equalised(const HrirSet& set);

inline constexpr double kEqualisedLength = 512.0 / 44100.0;  ///< seconds

}  // namespace earshot::audio
