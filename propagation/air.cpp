// SPDX-License-Identifier: MIT
#include "earshot/propagation/air.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/propagation/internal/air_kernel.h"

#include <cmath>
#include <string>

namespace earshot::propagation {

namespace {

constexpr double kZeroCelsius = 273.15;           // kelvin
constexpr double kReferenceTemperature = 293.15;  // kelvin
constexpr double kTriplePoint = 273.16;           // kelvin, of water
constexpr double kReferencePressure = 101.325;    // kilopascals

void check(
    const char* subject, double value, double min_value, double max_value, const char* unit) {
    if (!(value >= min_value && value <= max_value)) {
        throw Error(subject,
                    "is " + std::to_string(value) + " " + unit,
                    "give a value in " + std::to_string(static_cast<int>(min_value)) + " ... " +
                        std::to_string(static_cast<int>(max_value)));
    }
}

// Molar concentration of water vapour in per cent (ISO 9613-1, equations B.1 to B.3).
double water_vapour_percent(const Air& air) noexcept {
    const double kelvin = kZeroCelsius + air.temperature_c;
    const double exponent = -6.8346 * math::pow(kTriplePoint / kelvin, 1.261) + 4.6151;
    const double saturation = kReferencePressure * math::pow10(exponent);
    return air.humidity_percent * saturation / air.pressure_kpa;
}

}  // namespace

void validate(const Air& air) {
    check("temperature", air.temperature_c, -50.0, 70.0, "degrees C");
    check("humidity", air.humidity_percent, 0.0, 100.0, "%");
    check("air pressure", air.pressure_kpa, 10.0, 200.0, "kPa");
}

double speed_of_sound(const Air& air) noexcept {
    return 343.2 * std::sqrt((kZeroCelsius + air.temperature_c) / kReferenceTemperature);
}

double absorption_db_per_metre(const Air& air, double frequency_hz) noexcept {
    EARSHOT_ASSERT(frequency_hz >= 0.0);
    const double kelvin = kZeroCelsius + air.temperature_c;
    const double t = kelvin / kReferenceTemperature;
    const double p = air.pressure_kpa / kReferencePressure;
    const double h = water_vapour_percent(air);

    // Relaxation frequencies of oxygen and nitrogen, equations (3) and (4).
    const double oxygen_hz = p * (24.0 + 4.04e4 * h * (0.02 + h) / (0.391 + h));
    const double nitrogen_hz =
        p / std::sqrt(t) * (9.0 + 280.0 * h * math::exp(-4.170 * (math::pow(t, -1.0 / 3.0) - 1.0)));

    // Equation (5): classical losses, then the two relaxations.
    const double f_squared = frequency_hz * frequency_hz;
    const double classical = 1.84e-11 / p * std::sqrt(t);
    const double oxygen =
        0.01275 * math::exp(-2239.1 / kelvin) / (oxygen_hz + f_squared / oxygen_hz);
    const double nitrogen =
        0.1068 * math::exp(-3352.0 / kelvin) / (nitrogen_hz + f_squared / nitrogen_hz);
    return 8.686 * f_squared * (classical + (oxygen + nitrogen) / (t * t * std::sqrt(t)));
}

audio::Spectrum air_pressure(const Air& air, const audio::Bands& bands, double distance) noexcept {
    EARSHOT_ASSERT(distance >= 0.0);
    audio::Spectrum factor{};
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const double lost_db = distance * absorption_db_per_metre(air, bands.exact_hz()[band]);
        factor[band] = math::pow10(-lost_db / 20.0);
    }
    return factor;
}

AirAbsorption::AirAbsorption(const Air& air, const audio::Bands& bands) {
    constexpr std::size_t kLanes = 8;
    rates_.assign((bands.count() + kLanes - 1) / kLanes * kLanes, 0.0);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        rates_[band] = absorption_db_per_metre(air, bands.exact_hz()[band]);
    }
}

std::vector<double> AirAbsorption::pressures(std::span<const double> distances) const {
    std::vector<double> factors(distances.size() * stride());
    pressures_of_losses(rates_, distances, factors);
    return factors;
}

}  // namespace earshot::propagation
