// SPDX-License-Identifier: MIT
#include "earshot/scenes/tick_grid.h"

#include <gtest/gtest.h>

namespace earshot::scenes {
namespace {

TEST(TickGrid, TicksAreTheNearest) {
    EXPECT_EQ(ticks(0.35), 3500);
    EXPECT_EQ(ticks(-0.1), -1000);
    EXPECT_EQ(ticks(0.1 + 0.2), ticks(0.3));
}

TEST(TickGrid, AreaOfALoopHasTheSignOfItsTurn) {
    EXPECT_EQ(doubled_area({{0, 0}, {4, 0}, {4, 3}, {0, 3}}), 24);
    EXPECT_EQ(doubled_area({{0, 0}, {0, 3}, {4, 3}, {4, 0}}), -24);
}

TEST(TickGrid, TrianglesFillTheLoopsWithPointsOfTheGrid) {
    const std::vector<std::vector<GridPoint>> loops = {{{0, 0}, {100, 0}, {100, 100}, {0, 100}},
                                                       {{20, 20}, {20, 40}, {40, 40}, {40, 20}}};
    std::int64_t area = 0;
    const auto triangles = triangulate(loops);
    for (const auto& [a, b, c] : triangles) {
        EXPECT_GT(doubled_area({a, b, c}), 0);
        area += doubled_area({a, b, c});
    }
    EXPECT_EQ(triangles.size(), 8U);
    EXPECT_EQ(area, 2 * (100 * 100 - 20 * 20));
}

}  // namespace
}  // namespace earshot::scenes
