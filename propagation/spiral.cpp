// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/spiral.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace earshot::propagation {

geometry::Vec3 spiral_direction(std::uint64_t i, double count) noexcept {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / count;
    const double turns = static_cast<double>(i) / std::numbers::phi;
    const double angle = 2.0 * math::kPi * (turns - std::floor(turns));
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * math::cos(angle), r * math::sin(angle), z};
}

glm::dmat3 random_rotation(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) noexcept {
    // Three numbers of one index, each from a third of the indices.
    const auto chance = [&](std::uint64_t part) { return random(seed, stream, 3 * index + part); };
    const double share = chance(0);
    const double a = 2.0 * math::kPi * chance(1);
    const double b = 2.0 * math::kPi * chance(2);
    const double r = std::sqrt(1.0 - share), q = std::sqrt(share);
    const double x = r * math::sin(a), y = r * math::cos(a);
    const double z = q * math::sin(b), w = q * math::cos(b);
    // The matrix of the unit quaternion (w; x, y, z), column after column.
    return {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)},
            {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)},
            {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)}};
}

}  // namespace earshot::propagation
