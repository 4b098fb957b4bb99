// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// Unit vectors on a spiral of equal areas (Saff and Kuijlaars 1997).
inline std::vector<std::array<double, 3>> spiral_directions(std::size_t count) {
    std::vector<std::array<double, 3>> directions;
    const double turn = math::kPi * (3.0 - std::sqrt(5.0));
    for (std::size_t k = 0; k < count; ++k) {
        const auto at = static_cast<double>(k);
        const double z = 1.0 - (2.0 * at + 1.0) / static_cast<double>(count);
        const double radius = std::sqrt(1.0 - z * z);
        directions.push_back({radius * math::cos(turn * at), radius * math::sin(turn * at), z});
    }
    return directions;
}

}  // namespace earshot::audio
