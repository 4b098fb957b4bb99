// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <vector>

namespace earshot::audio {

/// Sound energy that arrives at a listener in intervals of equal length, per band. In units of a
/// free field's at 1 m: a path of pressure p (Arrival) brings p squared.
struct EnergyHistogram {
    double bin = 1e-3;  ///< seconds
    /// Of the interval from k * bin on.
    std::vector<Spectrum> energy;
    /// Standard error of each, as the rays tell it.
    std::vector<Spectrum> error;
};

}  // namespace earshot::audio
