// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

inline constexpr int kMaxAmbisonicOrder = 5;

/// Where a listener looks. Unit vectors at right angles to each other, left = up x front, in the
/// coordinates of the arrivals' directions.
struct Orientation {
    std::array<double, 3> front{1.0, 0.0, 0.0};
    std::array<double, 3> left{0.0, 1.0, 0.0};
    std::array<double, 3> up{0.0, 0.0, 1.0};
};

/// The unit vector to where the arrival comes from, in front, left, up components; zeros if its
/// direction has no length.
std::array<double, 3> origin_seen_from(const Orientation& orientation, const Arrival& arrival);

/// (order + 1)^2
std::size_t ambisonic_channels(int order) noexcept;

/// Real spherical harmonics of a direction, into `values` in ACN order with SN3D normalisation
/// (Nachbar et al. 2011): values[0] is 1, values[1..3] are y, z, x. `towards`: front, left, up
/// components of the unit vector to where the sound comes from. No Condon-Shortley phase.
/// Precondition: 0 <= order <= kMaxAmbisonicOrder, values.size() == ambisonic_channels(order).
void spherical_harmonics(int order, const std::array<double, 3>& towards, std::span<double> values);

/// The ambisonic response of a listener, a channel per spherical harmonic: an arrival is a plane
/// wave from where it comes. Channel 0 is the response of assemble(), to the bit. Directions need
/// not be of unit length; one of zero length is heard in channel 0 alone. Throws Error as
/// Assembler::assemble, or if the order is out of range.
std::vector<ImpulseResponse> encode_ambisonic(const Assembler& assembler,
                                              std::span<const Arrival> arrivals,
                                              int order,
                                              const Orientation& orientation = {},
                                              double length = 0.0,
                                              Executor& executor = Executor::serial());

}  // namespace earshot::audio
