// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/late_energy.h"
#include "earshot/propagation/room_statistics.h"

#include <string>

namespace earshot::propagation {

/// A reverberation time is long beyond this many times Eyring's.
inline constexpr double kLongDecay = 1.5;

/// Why sound of a source decays more slowly than Eyring's formula says, if its T30 (seconds, the
/// mean of 500 Hz and 1 kHz) is long: the materials between which sound runs to and fro, or the
/// part of the scene in which it stays. Found by rays with the scattering of the materials, from
/// the energy that is left in the interval in which T30 is measured; empty if there is none.
/// `options` are those of `room`. The same text for any executor.
std::string long_decay_cause(const RayScene& scene,
                             const geometry::Vec3& source,
                             double t30_mid,
                             const RoomStatistics& room,
                             const RoomStatisticsOptions& options = {},
                             Executor& executor = Executor::serial());

/// "T30 of 8.8 s is 19.6 times Eyring's 0.45 s: " and the cause.
std::string long_decay_note(double t30_mid, double eyring_mid, const std::string& cause);

}  // namespace earshot::propagation
