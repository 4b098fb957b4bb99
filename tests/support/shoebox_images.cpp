// SPDX-License-Identifier: MIT
#include "support/shoebox_images.h"

#include <glm/geometric.hpp>

#include <cstddef>
#include <cstdlib>

namespace earshot::support {

namespace {

// Along one axis, image i of the source: even ones are the source moved by whole periods, odd ones
// its mirror image in the low wall moved likewise.
double image_coordinate(double low, double high, double source, int i) {
    const double from_low = source - low;
    const double edge = high - low;
    return low + (i % 2 == 0 ? i * edge + from_low : (i + 1) * edge - from_low);
}

}  // namespace

std::vector<ShoeboxImage> shoebox_images(const geometry::Vec3& lower,
                                         const geometry::Vec3& upper,
                                         const geometry::Vec3& source,
                                         const geometry::Vec3& listener,
                                         int max_order) {
    std::vector<ShoeboxImage> images;
    for (int i = -max_order; i <= max_order; ++i) {
        for (int j = -max_order; j <= max_order; ++j) {
            for (int k = -max_order; k <= max_order; ++k) {
                const std::array<int, 3> lattice = {i, j, k};
                ShoeboxImage image;
                for (int axis = 0; axis < 3; ++axis) {
                    const int n = lattice[static_cast<std::size_t>(axis)];
                    const int count = std::abs(n);
                    image.order += count;
                    // The last wall met is the high one for n > 0, and they take turns.
                    const std::size_t low_wall = 2 * static_cast<std::size_t>(axis);
                    image.bounces[low_wall] = n > 0 ? count / 2 : (count + 1) / 2;
                    image.bounces[low_wall + 1] = count - image.bounces[low_wall];
                    image.position[axis] =
                        image_coordinate(lower[axis], upper[axis], source[axis], n);
                }
                image.length = glm::length(image.position - listener);
                if (image.order <= max_order) {
                    images.push_back(image);
                }
            }
        }
    }
    return images;
}

}  // namespace earshot::support
