// SPDX-License-Identifier: MIT
#include "earshot/audio/bands.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <utility>

namespace earshot::audio {

namespace {

// IEC 61260-1, 5.2: bands of a fraction b of an octave lie 10^(3 / (10 b)) apart around 1 kHz.
constexpr double kOctaveExponent = 0.3;
constexpr double kThirdOctaveExponent = 0.1;

}  // namespace

Bands::Bands(std::vector<double> nominal_hz, double first_exponent, double step, double width)
    : nominal_hz_(std::move(nominal_hz)), half_width_ratio_(math::pow10(width / 2.0)) {
    EARSHOT_ASSERT(nominal_hz_.size() <= kMaxBands);
    for (std::size_t band = 0; band < nominal_hz_.size(); ++band) {
        const double exponent = first_exponent + step * static_cast<double>(band);
        exact_hz_.push_back(1000.0 * math::pow10(exponent));
    }
}

const Bands& Bands::octaves() {
    static const Bands bands({31.5, 63, 125, 250, 500, 1000, 2000, 4000, 8000, 16000},
                             -5 * kOctaveExponent,
                             kOctaveExponent,
                             kOctaveExponent);
    return bands;
}

const Bands& Bands::third_octaves() {
    static const Bands bands({20,   25,   31.5, 40,   50,   63,    80,    100,   125,  160,  200,
                              250,  315,  400,  500,  630,  800,   1000,  1250,  1600, 2000, 2500,
                              3150, 4000, 5000, 6300, 8000, 10000, 12500, 16000, 20000},
                             -17 * kThirdOctaveExponent,
                             kThirdOctaveExponent,
                             kThirdOctaveExponent);
    return bands;
}

double Bands::lower_edge_hz(std::size_t band) const noexcept {
    EARSHOT_ASSERT(band < count());
    return exact_hz_[band] / half_width_ratio_;
}

double Bands::upper_edge_hz(std::size_t band) const noexcept {
    EARSHOT_ASSERT(band < count());
    return exact_hz_[band] * half_width_ratio_;
}

}  // namespace earshot::audio
