// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <vector>

namespace earshot::support {

/// One image of a source in a box (Allen and Berkley 1979): closed form, no search.
struct ShoeboxImage {
    int order = 0;
    std::array<int, 6> bounces{};  ///< per wall: low x, high x, low y, high y, low z, high z
    geometry::Vec3 position{};
    double length = 0.0;  ///< to the listener, metres
};

/// All images of order 0 ... max_order: (i, j, k) with |i| + |j| + |k| reflections.
std::vector<ShoeboxImage> shoebox_images(const geometry::Vec3& lower,
                                         const geometry::Vec3& upper,
                                         const geometry::Vec3& source,
                                         const geometry::Vec3& listener,
                                         int max_order);

}  // namespace earshot::support
