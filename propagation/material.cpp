// SPDX-License-Identifier: MIT
#include "earshot/propagation/material.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::propagation {

namespace {

using Point = EnergyCoefficient::Point;

// As short as reads back the same, whatever the locale.
std::string text(double number) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
    return {buffer.data(), end};
}

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Error("energy coefficient", what, remedy);
}

void check(const Point& point) {
    if (!(point.frequency_hz > 0.0 && point.frequency_hz <= std::numeric_limits<double>::max())) {
        refuse("is given at a frequency of " + text(point.frequency_hz) + " Hz",
               "give positive frequencies");
    }
    if (!(point.value >= 0.0 && point.value <= 1.0)) {
        refuse("is " + text(point.value) + " at " + text(point.frequency_hz) + " Hz",
               "give a value in 0 ... 1");
    }
}

double interpolate(const Point& low, const Point& high, double frequency_hz) noexcept {
    const double low_log = math::log(low.frequency_hz);
    const double weight =
        (math::log(frequency_hz) - low_log) / (math::log(high.frequency_hz) - low_log);
    const double value = low.value + (high.value - low.value) * weight;
    // Rounding may leave the interval by an ulp; a coefficient must not.
    return std::clamp(value, std::min(low.value, high.value), std::max(low.value, high.value));
}

}  // namespace

EnergyCoefficient::EnergyCoefficient(double value) : points_{{1000.0, value}} {
    check(points_.front());
}

EnergyCoefficient::EnergyCoefficient(std::vector<Point> points) : points_(std::move(points)) {
    if (points_.empty()) {
        refuse("has no value at any frequency", "give at least one");
    }
    for (const Point& point : points_) {
        check(point);
    }
    std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) {
        return a.frequency_hz < b.frequency_hz;
    });
    const auto twice =
        std::adjacent_find(points_.begin(), points_.end(), [](const Point& a, const Point& b) {
            return a.frequency_hz == b.frequency_hz;
        });
    if (twice != points_.end()) {
        refuse("is given twice at " + text(twice->frequency_hz) + " Hz", "give it once");
    }
}

double EnergyCoefficient::at(double frequency_hz) const noexcept {
    EARSHOT_ASSERT(frequency_hz > 0.0);
    const auto above = std::upper_bound(
        points_.begin(), points_.end(), frequency_hz, [](double frequency, const Point& point) {
            return frequency < point.frequency_hz;
        });
    if (above == points_.begin()) {
        return points_.front().value;
    }
    const Point& below = *(above - 1);
    if (above == points_.end() || below.frequency_hz == frequency_hz) {
        return below.value;
    }
    return interpolate(below, *above, frequency_hz);
}

audio::Spectrum EnergyCoefficient::over(const audio::Bands& bands) const noexcept {
    audio::Spectrum spectrum{};
    for (std::size_t band = 0; band < bands.count(); ++band) {
        double sum = 0.0;
        std::size_t count = 0;
        for (const Point& point : points_) {
            if (point.frequency_hz >= bands.lower_edge_hz(band) &&
                point.frequency_hz < bands.upper_edge_hz(band)) {
                sum += point.value;
                ++count;
            }
        }
        spectrum[band] =
            count > 1 ? sum / static_cast<double>(count) : at(bands.nominal_hz()[band]);
    }
    return spectrum;
}

void validate(const Material& material) {
    // Both are linear between points, so the points of both decide.
    for (const EnergyCoefficient* coefficient : {&material.absorption, &material.transmission}) {
        for (const Point& point : coefficient->points()) {
            const double absorption = material.absorption.at(point.frequency_hz);
            const double transmission = material.transmission.at(point.frequency_hz);
            if (transmission > absorption) {
                throw Error("material \"" + material.name + "\"",
                            "transmission " + text(transmission) + " exceeds absorption " +
                                text(absorption) + " at " + text(point.frequency_hz) + " Hz",
                            "absorption counts all that is not reflected: give at least as much");
            }
        }
    }
}

audio::Spectrum transmitted_energy(const Material& material, const audio::Bands& bands) noexcept {
    const audio::Spectrum absorption = material.absorption.over(bands);
    audio::Spectrum energy = material.transmission.over(bands);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        energy[band] = std::min(energy[band], absorption[band]);
    }
    return energy;
}

audio::Spectrum reflected_pressure(const Material& material, const audio::Bands& bands) noexcept {
    const audio::Spectrum absorption = material.absorption.over(bands);
    const audio::Spectrum scattering = material.scattering.over(bands);
    audio::Spectrum pressure{};
    for (std::size_t band = 0; band < bands.count(); ++band) {
        pressure[band] = std::sqrt((1.0 - absorption[band]) * (1.0 - scattering[band]));
    }
    return pressure;
}

audio::Spectrum transmitted_pressure(const Material& material, const audio::Bands& bands) noexcept {
    audio::Spectrum pressure = transmitted_energy(material, bands);
    for (std::size_t band = 0; band < bands.count(); ++band) {
        pressure[band] = std::sqrt(pressure[band]);
    }
    return pressure;
}

}  // namespace earshot::propagation
