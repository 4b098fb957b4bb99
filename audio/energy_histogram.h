// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <array>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// The sphere of directions in parts of one size: the quarters of the faces of a cube.
inline constexpr std::size_t kDirectionParts = 24;

/// The part that a direction of any length but 0 lies in.
std::size_t direction_part(const std::array<double, 3>& direction) noexcept;

/// The unit vector to the middle of a part. Precondition: part < kDirectionParts.
std::array<double, 3> middle_of_part(std::size_t part) noexcept;

/// Sound energy that arrives at a listener in intervals of equal length, per band. In units of a
/// free field's at 1 m: a path of pressure p (Arrival) brings p squared.
struct EnergyHistogram {
    double bin = 1e-3;  ///< seconds
    /// Of the interval from k * bin on.
    std::vector<Spectrum> energy{};
    /// Standard error of each, as the rays tell it.
    std::vector<Spectrum> error{};
    /// At time t, t squared times this many reflections arrive in a second; 0: too many at any time
    /// to be told apart.
    double reflection_growth = 0.0;
    /// It reaches to where the energy has decayed by some 60 dB in every band.
    bool full_decay = false;
    /// Where the energy comes from, part by part, in intervals of kBinsPerSpan bins; empty where
    /// nobody asked.
    std::vector<std::array<Spectrum, kDirectionParts>> directions{};
};

inline constexpr std::size_t kBinsPerSpan = 20;

/// What of the energy comes from one part of the sphere, without errors and directions.
/// Precondition: the histogram has directions.
EnergyHistogram energy_from(const EnergyHistogram& histogram, std::size_t part);

}  // namespace earshot::audio
