// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// The head-related impulse responses of both ears for a source in one direction, re the pressure
/// at the head's centre without the head. The time between the ears is in the samples.
struct Hrir {
    std::array<double, 3> towards{1.0, 0.0, 0.0};  ///< unit; front, left, up
    std::vector<double> left{};
    std::vector<double> right{};
    /// Metres from the head's centre to the source. A reader fills it in for every measurement; a
    /// set may hold each direction at several distances.
    double distance = 1.0;
};

/// The measurements around one head.
struct HrirSet {
    double sample_rate = 48000.0;  ///< hertz
    std::vector<Hrir> directions{};
    /// The instant in the responses at which the sound would arrive at the head's centre without
    /// the head, seconds; what is rendered arrives earlier by this time. A reader leaves it at 0,
    /// which renders the responses as they were measured.
    double centre_delay = 0.0;
};

/// The measurements at the largest distance, in their order: those within 10 % of it, as sources
/// are not always at equal distances. Arrivals are plane waves, which a far source comes closest
/// to.
HrirSet farthest_measurements(const HrirSet& set);

/// The same responses at another sample rate, by band-limited interpolation: what they have below
/// 0.95 of half the lower rate stays. A lower rate puts the ringing of the interpolation ahead of
/// the responses, and adds its length to `centre_delay`. Precondition: sample_rate > 0.
HrirSet resampled(const HrirSet& set, double sample_rate);

/// The entry whose direction is nearest, the first of equals. Precondition: there is one.
std::size_t closest_direction(const HrirSet& set, const std::array<double, 3>& towards);

/// What to give HrirSet::centre_delay so that direct sound arrives at d / c of the head's centre:
/// the delay that all responses have in common. It is fitted, together with the head's radius, to
/// the onsets of both ears in all directions by the delays of a spherical head (Woodworth 1938):
/// -a / c cos(angle) on the side of the ear, a / c (angle - pi / 2) behind. 0 if all responses are
/// silent.
double common_delay(const HrirSet& set);

}  // namespace earshot::audio
