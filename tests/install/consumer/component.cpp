// SPDX-License-Identifier: MIT
#include "earshot/geometry/aabb.h"

#include <cstdlib>

// A box of two points, from the installed geometry library alone.
int main() {
    earshot::geometry::Aabb box;
    box.include(earshot::geometry::Vec3{0.0, 0.0, 0.0});
    box.include(earshot::geometry::Vec3{1.0, 2.0, 3.0});
    const double expected_half_area = 1.0 * 2.0 + 2.0 * 3.0 + 3.0 * 1.0;
    return box.half_area() == expected_half_area ? EXIT_SUCCESS : EXIT_FAILURE;
}
