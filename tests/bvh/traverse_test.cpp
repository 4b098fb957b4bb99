// SPDX-License-Identifier: MIT
#include "earshot/bvh/traverse.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <set>

namespace earshot::bvh {
namespace {

TEST(Traverse, VisitsWhatOverlapsOnce) {
    const auto mesh = test::triangle_soup(1, 3000);
    const auto boxes = triangle_boxes(mesh.view());
    const Tree tree = Tree::build(boxes);
    const auto overlaps = [](const geometry::Aabb& box) {
        return box.lower[0] <= 0.3F && box.upper[0] >= 0.2F && box.lower[1] <= 0.3F &&
               box.upper[1] >= 0.1F;
    };
    std::multiset<std::uint32_t> visited;
    traverse(
        tree,
        [&](const Node& node) { return overlaps(node.box); },
        [&](std::uint32_t primitive) {
            visited.insert(primitive);
            return true;
        });
    std::size_t expected = 0;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        EXPECT_LE(visited.count(i), 1U);
        if (overlaps(boxes[i])) {
            EXPECT_EQ(visited.count(i), 1U);
            ++expected;
        }
    }
    EXPECT_GT(expected, 10U);
    EXPECT_LT(visited.size(), boxes.size() / 4);
}

TEST(Traverse, StopsWhenToldTo) {
    const auto mesh = test::triangle_soup(1, 3000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    int visits = 0;
    traverse(
        tree, [](const Node&) { return true; }, [&](std::uint32_t) { return ++visits < 7; });
    EXPECT_EQ(visits, 7);
}

TEST(Traverse, AnEmptyTreeHasNothingToVisit) {
    traverse(
        Tree(),
        [](const Node&) { return true; },
        [](std::uint32_t) {
            ADD_FAILURE();
            return true;
        });
}

}  // namespace
}  // namespace earshot::bvh
