// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The air that sound travels through.
struct Air {
    double temperature_c = 20.0;     ///< degrees Celsius, -50 ... 70
    double humidity_percent = 50.0;  ///< relative humidity, 0 ... 100
    double pressure_kpa = 101.325;   ///< 10 ... 200
};

/// Throws Error if a value is not finite or outside the range given above.
void validate(const Air& air);

/// Metres per second (ISO 9613-1:1993, annex A): 343.2 at 20 degrees C.
/// Precondition of this and the following: validate(air) passes.
double speed_of_sound(const Air& air) noexcept;

/// Attenuation of a pure tone by the air, decibels per metre (ISO 9613-1:1993, equations 3 to 5 and
/// B.1 to B.3). The standard gives 10 % accuracy for 50 Hz ... 10 kHz, -20 ... 50 degrees C and
/// below 200 kPa; outside, the formulas are evaluated as they stand. `frequency_hz` >= 0.
double absorption_db_per_metre(const Air& air, double frequency_hz) noexcept;

/// Factor of the pressure amplitude over `distance` metres (>= 0), per band at its exact centre.
audio::Spectrum air_pressure(const Air& air, const audio::Bands& bands, double distance) noexcept;

/// air_pressure() over many distances, to the bit: what depends on the air alone is prepared once.
class AirAbsorption {
public:
    AirAbsorption(const Air& air, const audio::Bands& bands);

    /// Factors of the pressure amplitude: stride() numbers per distance (metres, >= 0), of which
    /// the first are the bands'.
    std::vector<double> pressures(std::span<const double> distances) const;
    std::size_t stride() const noexcept { return rates_.size(); }
    /// Decibels per metre, per band and zeros up to stride().
    std::span<const double> rates() const noexcept { return rates_; }

private:
    std::vector<double> rates_;  // decibels per metre, per band, and zeros to a multiple of 8
};

}  // namespace earshot::propagation
