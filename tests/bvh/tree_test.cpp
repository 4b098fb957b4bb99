// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

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

}  // namespace
}  // namespace earshot::bvh
