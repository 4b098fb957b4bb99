// SPDX-License-Identifier: MIT
#include "earshot/base/parallel.h"
#include "earshot/geometry/aabb.h"

#include <cstddef>
#include <cstdlib>
#include <vector>

// Boxes in parallel: needs the installed libraries and the ones they bring along.
int main() {
    using earshot::geometry::Aabb;
    std::vector<Aabb> boxes(1000);
    earshot::Executor executor(2);
    executor.for_each(boxes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            boxes[i].include(earshot::geometry::Vec3{0.0, 0.0, 0.0});
            boxes[i].include(earshot::geometry::Vec3{1.0, 2.0, static_cast<double>(i)});
        }
    });
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i].half_area() != 2.0 + 3.0 * static_cast<double>(i)) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
