// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/region.h"

#include <cstdint>

namespace earshot::visibility {

/// A ray of uniform origin in the region and of uniform direction. It uses five streams of random
/// numbers: `first_stream` and the next two for the origin, then height and angle of the direction.
inline geometry::Ray random_ray(const ViewRegion& region,
                                std::uint64_t seed,
                                std::uint64_t first_stream,
                                std::uint64_t index) noexcept {
    geometry::Ray ray;
    for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = random_between(seed,
                                          first_stream + static_cast<std::uint64_t>(axis),
                                          index,
                                          region.lower[axis],
                                          region.upper[axis]);
    }
    ray.direction = on_sphere(random_between(seed, first_stream + 3, index, -1.0, 1.0),
                              2.0 * math::kPi * random(seed, first_stream + 4, index));
    return ray;
}

}  // namespace earshot::visibility
