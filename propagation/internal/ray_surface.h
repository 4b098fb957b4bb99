// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/propagation/material.h"

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

/// Sets what follows from the shares of a surface: all but those.
void set_probabilities(RaySurface& surface);

/// The front of a material, and the back where that is not one-sided. Without `transmission`,
/// what would pass is absorbed.
RaySurface ray_surface(const Material& material, const audio::Bands& bands, bool transmission);

/// The back of a one-sided material.
RaySurface perfect_absorber();

}  // namespace earshot::propagation
