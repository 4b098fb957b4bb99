// SPDX-License-Identifier: MIT
#include "earshot/visibility/visibility_matrix.h"

#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"

namespace earshot::visibility {
namespace {

using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;

std::vector<Vec3> some_points(std::size_t count, std::uint64_t seed) {
    support::Dice dice(seed);
    std::vector<Vec3> points(count);
    for (Vec3& point : points) {
        point = {dice.between(0.0, 12.0), dice.between(0.0, 3.0), dice.between(0.0, 12.0)};
    }
    return points;
}

TEST(VisibilityMatrix, HoldsEveryPairInItsPlace) {
    const geometry::Mesh mesh = scene_mesh("classroom");
    const auto tree = wide_tree_of(mesh.view());
    Executor two(2);
    // Rows longer than a batch, and many short ones.
    for (const auto& [rows, columns] : {std::pair(2, 300000), {700, 500}, {1, 1}, {0, 5}, {5, 0}}) {
        const auto from = some_points(static_cast<std::size_t>(rows), 1);
        const auto to = some_points(static_cast<std::size_t>(columns), 2);
        std::size_t row = 0, free = 0;
        support::Dice dice(3);
        visibility_matrix(
            {tree, mesh.view()}, {from, to}, {}, two, [&](std::span<const std::uint8_t> is) {
                ASSERT_EQ(is.size(), to.size());
                for (int i = 0; i < 20 && columns > 0; ++i) {
                    const auto k = static_cast<std::size_t>(dice.below(columns));
                    EXPECT_EQ(is[k] != 0, visible({tree, mesh.view()}, Segment{from[row], to[k]}));
                    free += is[k];
                }
                ++row;
            });
        EXPECT_EQ(row, from.size());
        EXPECT_TRUE(rows < 100 || (free > 0 && free < 20 * from.size()));
    }
}

TEST(VisibilityMatrix, NamesTheFirstBlockers) {
    const geometry::Mesh mesh = scene_mesh("classroom");
    const auto tree = wide_tree_of(mesh.view());
    const auto from = some_points(20, 4), to = some_points(50, 5);
    std::size_t row = 0;
    blocker_matrix(
        {tree, mesh.view()},
        {from, to},
        {},
        Executor::serial(),
        [&](std::span<const TriangleId> blockers) {
            for (std::size_t k = 0; k < to.size(); ++k) {
                const auto first = first_blocker({tree, mesh.view()}, Segment{from[row], to[k]});
                EXPECT_EQ(blockers[k], first ? first->triangle : kNoBlocker);
            }
            ++row;
        });
    EXPECT_EQ(row, from.size());
}

}  // namespace
}  // namespace earshot::visibility
