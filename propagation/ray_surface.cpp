// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_surface.h"

#include <cmath>
#include <cstddef>

namespace earshot::propagation {

void set_probabilities(RaySurface& surface) {
    double total = 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        surface.kept[band] =
            surface.specular[band] + surface.scattered[band] + surface.transmitted[band];
        if (surface.kept[band] > total) {
            total = surface.kept[band];
            surface.scattering_probability = surface.scattered[band] / total;
            surface.transmission_probability = surface.transmitted[band] / total;
        }
    }
    surface.rain_probability = std::sqrt(surface.scattering_probability);
    surface.uniform_split = total > 0.0;
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        // A few roundings, which the balance of energy does not feel.
        constexpr double kRounding = 0x1p-50;
        const auto is_share = [&](double part, double probability) {
            return std::abs(part - probability * surface.kept[band]) <=
                   kRounding * surface.kept[band];
        };
        surface.uniform_split =
            surface.uniform_split &&
            is_share(surface.scattered[band], surface.scattering_probability) &&
            is_share(surface.transmitted[band], surface.transmission_probability);
    }
}

RaySurface ray_surface(const Material& material, const audio::Bands& bands, bool transmission) {
    const audio::Spectrum absorption = material.absorption.over(bands);
    const audio::Spectrum scattering = material.scattering.over(bands);
    const audio::Spectrum passing = transmitted_energy(material, bands);
    RaySurface surface;
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const double kept = 1.0 - absorption[band];
        // Transmitted energy is a part of the energy that is not reflected.
        const double transmitted = transmission ? passing[band] : 0.0;
        surface.specular[band] = kept * (1.0 - scattering[band]);
        surface.scattered[band] = kept * scattering[band];
        surface.transmitted[band] = transmitted;
        surface.absorbed[band] = absorption[band] - transmitted;
    }
    set_probabilities(surface);
    return surface;
}

RaySurface perfect_absorber() {
    RaySurface surface;
    surface.absorbed.fill(1.0);
    return surface;
}

}  // namespace earshot::propagation
