// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::bvh {
namespace {

TEST(TriangleBoxes, HoldTheirCornersAndDoNotDependOnThreads) {
    const auto mesh = test::triangle_soup(1, 40000);
    const auto boxes = triangle_boxes(mesh.view());
    Executor executor(8);
    EXPECT_EQ(triangle_boxes(mesh.view(), executor), boxes);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (const geometry::VertexId vertex : mesh.triangles[i]) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto k = static_cast<std::size_t>(axis);
                EXPECT_LE(static_cast<double>(boxes[i].lower[k]), mesh.positions[vertex][axis]);
                EXPECT_GE(static_cast<double>(boxes[i].upper[k]), mesh.positions[vertex][axis]);
            }
        }
    }
}

// Coordinates of any size and sign, with and without a float of the same value.
TEST(TriangleBoxes, AreRoundedOutward) {
    std::vector<double> values = {0.0,
                                  -0.0,
                                  1e-46,
                                  -1e-46,
                                  1e-310,
                                  1.5,
                                  -1.5,
                                  3.4e38,
                                  -3.4e38,
                                  1e300,
                                  -1e300,
                                  16777217.0,
                                  -16777217.0};
    for (std::uint64_t i = 0; i < 500; ++i) {
        values.push_back(std::ldexp(random_between(1, 0, i, -1.0, 1.0),
                                    static_cast<int>(random_between(1, 1, i, -150.0, 130.0))));
        values.push_back(static_cast<double>(static_cast<float>(values.back())));
    }
    for (std::size_t i = 0; i + 2 < values.size(); ++i) {
        const geometry::Mesh mesh = {{geometry::Vec3(values[i]),
                                      geometry::Vec3(values[i + 1]),
                                      geometry::Vec3(values[i + 2])},
                                     {{0, 1, 2}}};
        const geometry::Aabb box = triangle_boxes(mesh.view()).front();
        const auto [low, high] = std::minmax({values[i], values[i + 1], values[i + 2]});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(box.lower[axis], geometry::round_down(low)) << low;
            EXPECT_EQ(box.upper[axis], geometry::round_up(high)) << high;
        }
    }
}

}  // namespace
}  // namespace earshot::bvh
