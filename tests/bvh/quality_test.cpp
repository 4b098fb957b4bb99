// SPDX-License-Identifier: MIT
#include "earshot/bvh/quality.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace earshot::bvh {
namespace {

using geometry::Aabb;

TEST(SahCost, FollowsItsDefinition) {
    // Two unit cubes at the ends of a 10 x 1 x 1 box: half areas 3, 3 and 21.
    const std::vector<Aabb> boxes = {Aabb{{0, 0, 0}, {1, 1, 1}}, Aabb{{9, 0, 0}, {10, 1, 1}}};
    const Tree tree = Tree::build(boxes, {.max_leaf_size = 1});
    EXPECT_DOUBLE_EQ(sah_cost(tree), 1.0 + 2.0 * 3.0 / 21.0);
    EXPECT_DOUBLE_EQ(sah_cost(tree, 5.0), 5.0 + 2.0 * 3.0 / 21.0);
    EXPECT_EQ(sah_cost(Tree()), 0.0);
}

TEST(SahCost, OfARootWithoutAreaIsAllTheWork) {
    const std::vector<Aabb> boxes(2, Aabb{{1, 1, 1}, {1, 1, 1}});
    EXPECT_DOUBLE_EQ(sah_cost(Tree::build(boxes, {.max_leaf_size = 1})), 3.0);
}

TEST(Quality, CountsNodesLeavesDepthAndBytes) {
    const std::vector<Aabb> boxes = {
        Aabb{{0, 0, 0}, {1, 1, 1}}, Aabb{{4, 0, 0}, {5, 1, 1}}, Aabb{{9, 0, 0}, {10, 1, 1}}};
    const Quality result = quality(Tree::build(boxes, {.max_leaf_size = 1}));
    EXPECT_EQ(result.nodes, 5U);
    EXPECT_EQ(result.leaves, 3U);
    EXPECT_EQ(result.depth, 2U);
    EXPECT_EQ(result.bytes, 5U * 32U + 3U * 4U);
}

TEST(SahCost, OfAWideTreeCountsTheRootAndWeighsTheRest) {
    // One leaf in a node: both are visited by every ray that hits the box.
    const geometry::Mesh mesh = test::triangle_soup(7, 4);
    const auto wide = WideTree::build(
        Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = 15, .traversal_cost = 1e6}),
        mesh.view());
    EXPECT_DOUBLE_EQ(sah_cost(wide), 2.0);
    EXPECT_EQ(sah_cost(WideTree()), 0.0);
}

}  // namespace
}  // namespace earshot::bvh
