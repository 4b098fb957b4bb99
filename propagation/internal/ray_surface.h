// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

namespace earshot::propagation {

/// How one side of a material splits sound that arrives.
struct RaySurface {
    /// Shares of what arrives, per band.
    audio::Spectrum absorbed{}, specular{}, scattered{}, transmitted{};
    audio::Spectrum kept{};  ///< specular + scattered + transmitted
    /// Every band splits alike: then the branching probabilities do not depend on the ray.
    bool uniform_split = false;
    double scattering_probability = 0.0, transmission_probability = 0.0;  ///< if so
    double rain_probability = 0.0;                                        ///< likewise
};

}  // namespace earshot::propagation
