// SPDX-License-Identifier: MIT
#include "earshot/audio/energy_histogram.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::audio {

std::size_t direction_part(const std::array<double, 3>& direction) noexcept {
    const double x = std::abs(direction[0]);
    const double y = std::abs(direction[1]);
    const double z = std::abs(direction[2]);
    const std::size_t axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    return 8 * axis + (direction[0] < 0.0 ? 1 : 0) + (direction[1] < 0.0 ? 2 : 0) +
           (direction[2] < 0.0 ? 4 : 0);
}

std::array<double, 3> middle_of_part(std::size_t part) noexcept {
    constexpr double kTangent = 0.41421356237309503;  // of half the angle of a face's half
    const double length = std::sqrt(1.0 + 2.0 * kTangent * kTangent);
    std::array<double, 3> middle{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = (part / 8 == axis ? 1.0 : kTangent) / length;
        middle[axis] = (part >> axis & 1) != 0 ? -size : size;
    }
    return middle;
}

EnergyHistogram energy_from(const EnergyHistogram& histogram, std::size_t part) {
    EARSHOT_ASSERT(histogram.directions.size() * kBinsPerSpan >= histogram.energy.size());
    EnergyHistogram result{.bin = histogram.bin,
                           .energy = histogram.energy,
                           .error = {},
                           .reflection_growth = histogram.reflection_growth,
                           .full_decay = histogram.full_decay,
                           .directions = {}};
    for (std::size_t span = 0; span < histogram.directions.size(); ++span) {
        const auto& parts = histogram.directions[span];
        Spectrum share{};
        for (std::size_t band = 0; band < kMaxBands; ++band) {
            double whole = 0.0;
            for (const Spectrum& energy : parts) {
                whole += energy[band];
            }
            share[band] = whole > 0.0 ? parts[part][band] / whole : 0.0;
        }
        const std::size_t end = std::min((span + 1) * kBinsPerSpan, result.energy.size());
        for (std::size_t n = span * kBinsPerSpan; n < end; ++n) {
            for (std::size_t band = 0; band < kMaxBands; ++band) {
                result.energy[n][band] *= share[band];
            }
        }
    }
    return result;
}

}  // namespace earshot::audio
