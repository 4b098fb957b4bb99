// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::propagation {

/// An energy coefficient (0..1) given at some frequencies, interpolated linearly over the logarithm
/// of the frequency and held at the ends.
class EnergyCoefficient {
public:
    struct Point {
        double frequency_hz = 0.0;
        double value = 0.0;
    };

    EnergyCoefficient() = default;
    /// The same at every frequency. Throws Error if `value` is not in 0..1.
    explicit EnergyCoefficient(double value);
    /// Sorts the points. Throws Error if there is none, a frequency is not positive and finite or
    /// stands twice, or a value is not in 0..1.
    explicit EnergyCoefficient(std::vector<Point> points);

    double at(double frequency_hz) const noexcept;  ///< precondition: frequency_hz > 0
    /// Per band: the mean of the points within the band where there are several, as of thirds
    /// within an octave; else the value at its nominal centre.
    audio::Spectrum over(const audio::Bands& bands) const noexcept;
    std::span<const Point> points() const noexcept { return points_; }

private:
    std::vector<Point> points_{{1000.0, 0.0}};
};

/// How a surface treats sound. Energy coefficients; of the energy that arrives, `absorption` is not
/// reflected, `transmission` of all passes through, as a part of `absorption`, and `scattering` of
/// what is reflected leaves the specular path.
struct Material {
    std::string name;
    EnergyCoefficient absorption{0.1};
    EnergyCoefficient scattering{0.0};
    EnergyCoefficient transmission{0.0};
    bool one_sided = false;  ///< reflects only on the front (counter-clockwise) side
};

/// Throws Error if transmission exceeds absorption at a frequency: more energy would leave the
/// surface than arrives.
void validate(const Material& material);

/// Energy that passes through, per band: transmission, at most absorption. Band averages of the two
/// may differ where they are given at different frequencies.
audio::Spectrum transmitted_energy(const Material& material, const audio::Bands& bands) noexcept;

/// Factor of the pressure amplitude in one specular reflection, per band:
/// sqrt((1 - absorption) (1 - scattering)).
audio::Spectrum reflected_pressure(const Material& material, const audio::Bands& bands) noexcept;

/// Factor of the pressure amplitude on the way straight through, per band: the root of
/// transmitted_energy().
audio::Spectrum transmitted_pressure(const Material& material, const audio::Bands& bands) noexcept;

/// A row of the built-in library.
struct LibraryMaterial {
    std::string_view name;  ///< "brick-painted": lower case, hyphens
    std::string_view description;
    std::string_view source;  ///< of the absorption: author, year, table
    /// Of the scattering: literature, or "estimate: " and the rule that it follows.
    std::string_view scattering_source;
    Material material;
};

/// All rows, ordered by name.
std::span<const LibraryMaterial> material_library();

/// The library's material of that name, or nothing.
std::optional<Material> find_library_material(std::string_view name);

}  // namespace earshot::propagation
