// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <array>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// The number of parts that the sphere of directions is divided into, of equal solid angle: the
/// quarters of the faces of a cube, projected on the sphere.
inline constexpr std::size_t kDirectionParts = 24;

/// The part that a direction of any length but 0 lies in.
std::size_t direction_part(const std::array<double, 3>& direction) noexcept;

/// The unit vector to the middle of a part. Precondition: part < kDirectionParts.
std::array<double, 3> middle_of_part(std::size_t part) noexcept;

/// Sound energy that arrives at a listener in intervals of equal length, per band. In units of a
/// free field's at 1 m: a path of pressure p (Arrival) brings p squared.
struct EnergyHistogram {
    double bin = 1e-3;  ///< seconds
    /// Entry k: of the interval that begins at k * bin.
    std::vector<Spectrum> energy{};
    /// Standard error of each entry of `energy`, estimated from the rays.
    std::vector<Spectrum> error{};
    /// The reflection density at time t is reflection_growth * t squared, per second. 0: the
    /// density is too high at any time for reflections to be resolved.
    double reflection_growth = 0.0;
    /// Whether the histogram extends until the energy has decayed by about 60 dB in every band.
    bool full_decay = false;
    /// The energy that arrives from each part of the sphere, in intervals of kBinsPerSpan bins;
    /// empty if directions are not requested.
    std::vector<std::array<Spectrum, kDirectionParts>> directions{};
};

inline constexpr std::size_t kBinsPerSpan = 20;

/// Independent estimates of one histogram, equally trustworthy, in coarse intervals: their spread
/// tells how certain their mean is (jackknife).
struct HistogramReplicates {
    /// First bin of each interval, and the number of bins: ascending, 0 first.
    std::vector<std::size_t> first_bin{};
    /// Energy per replicate and interval, in the units of EnergyHistogram::energy. The histogram is
    /// the mean of the replicates.
    std::vector<std::vector<Spectrum>> energy{};
};

/// The energy that arrives from one part of the sphere, without errors and directions.
/// Precondition: the histogram has directions.
EnergyHistogram energy_from(const EnergyHistogram& histogram, std::size_t part);

}  // namespace earshot::audio
