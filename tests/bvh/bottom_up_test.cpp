// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/bottom_up.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <atomic>
#include <vector>

namespace earshot::bvh {
namespace {

TEST(BottomUp, VisitsEveryNodeOnceAndChildrenBeforeTheirParents) {
    // More nodes than one task takes.
    const auto mesh = test::triangle_soup(1, 30000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = 1});
    for (const int threads : {1, 2, 8}) {
        Executor executor(threads);
        std::vector<std::atomic<int>> visits(tree.nodes().size());
        std::atomic<int> too_early = 0;
        for_each_bottom_up(tree.nodes(), executor, [&](std::size_t index) {
            const Node& node = tree.nodes()[index];
            if (!node.is_leaf() && (visits[node.first] != 1 || visits[node.first + 1] != 1)) {
                ++too_early;
            }
            ++visits[index];
        });
        EXPECT_EQ(too_early, 0) << threads;
        for (const auto& count : visits) {
            ASSERT_EQ(count, 1) << threads;
        }
    }
}

TEST(BottomUp, VisitsNothingInAnEmptyTree) {
    for_each_bottom_up(std::span<const Node>{}, Executor::serial(), [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace earshot::bvh
