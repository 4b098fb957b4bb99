// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/spatial.h"

#include <array>
#include <span>
#include <vector>

namespace earshot::audio {

/// The head-related impulse responses of both ears for a source in one direction, re the pressure
/// at the head's centre without the head. The time between the ears is in the samples.
struct Hrir {
    std::array<double, 3> towards{1.0, 0.0, 0.0};  ///< unit; front, left, up
    std::vector<double> left;
    std::vector<double> right;
    /// Metres from the head's centre to the source. A reader fills it in for every measurement; a
    /// set may hold each direction at several distances.
    double distance = 1.0;
};

/// The measurements around one head.
struct HrirSet {
    double sample_rate = 48000.0;  ///< hertz
    std::vector<Hrir> directions;
    /// The instant in the responses at which the sound would arrive at the head's centre without
    /// the head, seconds; what is rendered arrives earlier by this time. A reader leaves it at 0,
    /// which renders the responses as they were measured.
    double centre_delay = 0.0;
};

/// The same responses at a higher sample rate, by band-limited interpolation. Throws Error if the
/// rate is lower than theirs.
HrirSet resampled(const HrirSet& head, double sample_rate);

/// The entry whose direction is nearest, the first of equals. Precondition: there is one.
std::size_t closest_direction(const HrirSet& head, const std::array<double, 3>& towards);

/// The responses of both ears, left first, equally long: every arrival through the head response of
/// the nearest measured direction, without interpolation, so that the time and level between the
/// ears are as measured. Arrivals without a direction are taken from the front. `length` as in
/// ResponseOptions. Throws Error as Assembler::assemble, or if there are no head responses.
/// Precondition: the assembler has the sample rate of the head responses.
std::array<ImpulseResponse, 2> render_binaural(const Assembler& assembler,
                                               std::span<const Arrival> arrivals,
                                               const HrirSet& head,
                                               const Orientation& orientation = {},
                                               double length = 0.0,
                                               Executor& executor = Executor::serial());

}  // namespace earshot::audio
