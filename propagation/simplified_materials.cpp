// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/simplified_materials.h"

#include "earshot/audio/bands.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

/// Less depth than this, metres, scatters less than 0.025 at 8 kHz: no reason to change data.
constexpr double kMinDepth = 1e-4;

/// Areas that agree to this share are equal but for rounding.
constexpr double kMaxAreaDifference = 1e-6;

using Member = EnergyCoefficient Material::*;

void add_frequencies(const EnergyCoefficient& coefficient, std::vector<double>& frequencies) {
    for (const EnergyCoefficient::Point& point : coefficient.points()) {
        frequencies.push_back(point.frequency_hz);
    }
}

/// Where the coefficients of the materials are given.
std::vector<double> frequencies_of(std::span<const ReplacedSurface> replaced,
                                   std::initializer_list<Member> members,
                                   bool in_octaves) {
    std::vector<double> frequencies;
    for (const ReplacedSurface& surface : replaced) {
        for (const Member member : members) {
            add_frequencies(surface.material->*member, frequencies);
        }
    }
    if (in_octaves) {
        const std::span<const double> octaves = audio::Bands::octaves().nominal_hz();
        frequencies.insert(frequencies.end(), octaves.begin(), octaves.end());
    }
    std::sort(frequencies.begin(), frequencies.end());
    frequencies.erase(std::unique(frequencies.begin(), frequencies.end()), frequencies.end());
    return frequencies;
}

double total_area(std::span<const ReplacedSurface> replaced) {
    double sum = 0.0;
    for (const ReplacedSurface& surface : replaced) {
        sum += surface.area;
    }
    return sum;
}

/// Square metres that the coefficient of all comes to.
double equivalent_area(std::span<const ReplacedSurface> replaced, Member member, double frequency) {
    double sum = 0.0;
    for (const ReplacedSurface& surface : replaced) {
        sum += surface.area * (surface.material->*member).at(frequency);
    }
    return sum;
}

/// The depth of a structure whose points are spread evenly over it: their distances from its face
/// have the root mean square depth / sqrt(3).
double depth_of(std::span<const ReplacedSurface> replaced) {
    double squares = 0.0;
    for (const ReplacedSurface& surface : replaced) {
        squares += surface.area * surface.rms_distance * surface.rms_distance;
    }
    const double area = total_area(replaced);
    return area > 0.0 ? std::sqrt(3.0 * squares / area) : 0.0;
}

}  // namespace

double structure_scattering(double depth, double frequency_hz) {
    constexpr double kSpeedOfSound = 343.2;
    constexpr double kMaxScattering = 0.99;
    return std::min(kMaxScattering, 0.5 * std::sqrt(depth * frequency_hz / kSpeedOfSound));
}

SubstituteMaterial substitute_material(Material material,
                                       std::span<const ReplacedSurface> replaced,
                                       double area) {
    SubstituteMaterial result{.material = std::move(material), .removed_depth = depth_of(replaced)};
    const double old_area = total_area(replaced);
    const bool has_one_material =
        std::all_of(replaced.begin(), replaced.end(), [&](const ReplacedSurface& surface) {
            return surface.material == replaced.front().material;
        });
    const bool has_depth = result.removed_depth >= kMinDepth;
    const bool has_area = std::abs(area - old_area) > kMaxAreaDifference * old_area;
    if (!(area > 0.0) || (has_one_material && !has_depth && !has_area)) {
        return result;
    }
    result.is_new = true;
    std::vector<EnergyCoefficient::Point> absorption;
    std::vector<EnergyCoefficient::Point> transmission;
    for (const double f :
         frequencies_of(replaced, {&Material::absorption, &Material::transmission}, false)) {
        const double absorbed = equivalent_area(replaced, &Material::absorption, f) / area;
        const double passed = equivalent_area(replaced, &Material::transmission, f) / area;
        absorption.push_back({f, std::min(1.0, absorbed)});
        transmission.push_back({f, std::min(absorption.back().value, passed)});
        result.is_limited = result.is_limited || absorbed > 1.0 + kMaxAreaDifference;
    }
    result.material.absorption = EnergyCoefficient(std::move(absorption));
    result.material.transmission = EnergyCoefficient(std::move(transmission));
    std::vector<EnergyCoefficient::Point> scattering;
    for (const double f : frequencies_of(replaced, {&Material::scattering}, has_depth)) {
        // What the structure does not scatter meets the surface's own roughness.
        const double own = equivalent_area(replaced, &Material::scattering, f) / old_area;
        const double added = has_depth ? structure_scattering(result.removed_depth, f) : 0.0;
        scattering.push_back({f, std::clamp(1.0 - (1.0 - own) * (1.0 - added), 0.0, 1.0)});
    }
    result.material.scattering = EnergyCoefficient(std::move(scattering));
    return result;
}

}  // namespace earshot::propagation
