// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/late_energy.h"

#include <optional>
#include <span>

namespace earshot::propagation {

struct RoomStatisticsOptions {
    audio::Bands bands = audio::Bands::octaves();
    Air air{};
    bool air_absorption = true;
};

/// The air that sound of the sources reaches, and the reverberation times of diffuse sound in it.
struct RoomStatistics {
    double volume = 0.0;  ///< cubic metres
    double surface =
        0.0;  ///< square metres: the sides of triangles that sound reaches, no openings
    double opening = 0.0;  ///< square metres through which sound leaves the scene
    /// Energy absorption coefficient per band: the mean over surface and opening, which absorbs
    /// all.
    audio::Spectrum absorption{};
    /// Seconds per band, after Sabine and after Eyring (Kuttruff 2009, chapter 5); infinite where
    /// nothing absorbs.
    audio::Spectrum sabine{}, eyring{};
};

/// Measured with rays that every surface reflects by Lambert's law: their mean free path is
/// 4 volume / (surface + opening), whatever the shape of the room (Kuttruff 2009, chapter 5).
/// Sources that sound cannot link add up. Empty if more of the sound leaves the scene at each
/// reflection than meets another surface, as outdoors. The same bits for any executor.
std::optional<RoomStatistics> room_statistics(const RayScene& scene,
                                              std::span<const geometry::Vec3> sources,
                                              const RoomStatisticsOptions& options = {},
                                              Executor& executor = Executor::serial());

}  // namespace earshot::propagation
