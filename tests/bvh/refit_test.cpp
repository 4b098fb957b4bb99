// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/tree_walker.h"
#include <cstring>

namespace earshot::bvh {
namespace {

geometry::Mesh shaken(geometry::Mesh mesh, std::uint64_t seed, double size) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] += size * test::random_point(seed, i);
    }
    return mesh;
}

TEST(Refit, KeepsEveryPrimitiveInsideItsNode) {
    const auto mesh = test::triangle_soup(3, 30000);
    Tree tree = Tree::build(triangle_boxes(mesh.view()));
    for (std::uint64_t frame = 0; frame < 5; ++frame) {
        const auto boxes = triangle_boxes(shaken(mesh, frame, 0.3).view());
        tree.refit(boxes);
        ASSERT_EQ(test::fault_of(tree, boxes, 4), "") << "frame " << frame;
    }
}

TEST(Refit, ToTheSameBoxesChangesNothing) {
    const auto boxes = triangle_boxes(test::triangle_soup(4, 30000).view());
    const Tree built = Tree::build(boxes);
    Tree tree = built;
    tree.refit(boxes);
    EXPECT_EQ(std::memcmp(tree.nodes().data(), built.nodes().data(), built.nodes().size_bytes()),
              0);
}

TEST(Refit, DoesNotDependOnTheNumberOfThreads) {
    const auto mesh = test::triangle_soup(5, 60000);
    const auto moved = triangle_boxes(shaken(mesh, 1, 0.5).view());
    Tree expected = Tree::build(triangle_boxes(mesh.view()));
    Tree tree = expected;
    expected.refit(moved);
    Executor executor(8);
    tree.refit(moved, executor);
    EXPECT_EQ(std::memcmp(tree.nodes().data(), expected.nodes().data(), tree.nodes().size_bytes()),
              0);
}

TEST(Refit, OfAnEmptyTreeIsEmpty) {
    Tree tree;
    tree.refit({});
    EXPECT_TRUE(tree.nodes().empty());
}

}  // namespace
}  // namespace earshot::bvh
