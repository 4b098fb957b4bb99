// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_interpolator.h"
#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// Filters from the channels of an ambisonic sound field (ACN, SN3D, the listener's frame) to both
/// ears.
struct HarmonicHrirs {
    std::size_t latency = 0;  ///< samples by which the ears hear later than a HrirInterpolator says
    /// Per ear, left first, and channel; all equally long.
    std::array<std::vector<std::vector<double>>, 2> ears{};
};

/// Least squares over directions all around: of the complex spectrum up to 2 kHz, above, where a
/// low order has no phase to give, of its magnitude (Schoerkhuber, Zaunschirm, Hoeldrich 2018).
HarmonicHrirs harmonic_hrirs(const HrirInterpolator& hrirs, int order);

}  // namespace earshot::audio
