// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/slot_nodes.h"

#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>

namespace earshot::bvh {
namespace {

using geometry::Mesh;

Mesh moved(Mesh mesh) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] += 0.3 * test::random_point(3, i);
    }
    return mesh;
}

// The wide tree itself is the oracle, at the pose of the collapse and at another.
TEST(SlotNodes, GiveTheCostOfTheWideTree) {
    for (const std::size_t count : {1U, 2U, 5U, 9U, 40U, 300U, 3000U}) {
        for (const Builder builder : {Builder::binned_sah, Builder::lbvh, Builder::quality}) {
            for (const int leaf_size : {1, 4, 8}) {
                const Mesh mesh = test::triangle_soup(count, count);
                Tree tree = Tree::build(triangle_boxes(mesh.view()),
                                        {.builder = builder, .max_leaf_size = leaf_size});
                WideTree wide = WideTree::build(tree, mesh.view());
                const auto slots = slot_nodes(tree, wide);
                EXPECT_NEAR(sah_cost(tree, slots), sah_cost(wide), 1e-12 * sah_cost(wide));
                const Mesh after = moved(mesh);
                tree.refit(triangle_boxes(after.view()));
                wide.refit(after.view());
                EXPECT_NEAR(sah_cost(tree, slots), sah_cost(wide), 1e-12 * sah_cost(wide));
            }
        }
    }
}

// The runs of a leaf that fills two slots have boxes no larger than the leaf's.
TEST(SlotNodes, BoundTheCostWhereALeafFillsTwoSlots) {
    const Mesh mesh = test::triangle_soup(7, 1000);
    const Tree tree =
        Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = 15, .traversal_cost = 1e6});
    ASSERT_TRUE(std::ranges::any_of(tree.nodes(), [](const Node& node) { return node.count > 8; }));
    const WideTree wide = WideTree::build(tree, mesh.view());
    const double cost = sah_cost(tree, slot_nodes(tree, wide));
    EXPECT_GE(cost, sah_cost(wide));
    EXPECT_LE(cost, 2.0 * sah_cost(wide));
}

TEST(SlotNodes, OfNothingAreNone) {
    EXPECT_TRUE(slot_nodes({}, {}).empty());
    const Mesh point = {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}};
    const Tree tree = Tree::build(triangle_boxes(point.view()));
    const WideTree wide = WideTree::build(tree, point.view());
    EXPECT_GT(sah_cost(tree, slot_nodes(tree, wide)), 0.0);
}

}  // namespace
}  // namespace earshot::bvh
