// SPDX-License-Identifier: MIT
#include "earshot/scenes/triangulate.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

namespace earshot::scenes {
namespace {

using Loop = std::vector<GridPoint>;
using Loops = std::vector<Loop>;

std::int64_t area_of(const std::vector<std::array<GridPoint, 3>>& triangles) {
    std::int64_t area = 0;
    for (const auto& [a, b, c] : triangles) {
        EXPECT_GT(doubled_area(a, b, c), 0);
        area += doubled_area(a, b, c);
    }
    return area;
}

// Areas that add up do not rule out overlaps; edges that pair up within the border do.
void expect_fills(const Loops& loops) {
    const auto triangles = triangulate(loops);
    std::int64_t area = 0;
    std::size_t corners = 0;
    std::set<std::array<std::int64_t, 4>> border;
    for (const Loop& loop : loops) {
        area += doubled_area(loop);
        corners += loop.size();
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const GridPoint& next = loop[(i + 1) % loop.size()];
            border.insert({loop[i].u, loop[i].v, next.u, next.v});
        }
    }
    EXPECT_EQ(area_of(triangles), area);
    EXPECT_EQ(triangles.size(), corners + 2 * (loops.size() - 1) - 2);

    std::map<std::array<std::int64_t, 4>, int> uses;
    for (const auto& triangle : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const GridPoint& a = triangle[i];
            const GridPoint& b = triangle[(i + 1) % 3];
            ++uses[{a.u, a.v, b.u, b.v}];
        }
    }
    for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1);
        const bool inside = uses.count({edge[2], edge[3], edge[0], edge[1]}) != 0;
        EXPECT_NE(inside, border.count(edge) != 0);
    }
}

TEST(Triangulate, FillsConvexAndConcavePolygons) {
    expect_fills({{{0, 0}, {10, 0}, {10, 10}, {0, 10}}});
    expect_fills({{{0, 0}, {60, 0}, {60, 30}, {30, 30}, {30, 60}, {0, 60}}});
    expect_fills({{{0, 0}, {9, 0}, {9, 9}, {6, 9}, {6, 3}, {3, 3}, {3, 9}, {0, 9}}});
}

TEST(Triangulate, UsesCornersOnStraightRuns) {
    expect_fills({{{0, 0}, {3, 0}, {5, 0}, {10, 0}, {10, 4}, {10, 10}, {6, 10}, {0, 10}}});
}

TEST(Triangulate, LeavesHolesOut) {
    const Loop outline = {{0, 0}, {100, 0}, {100, 100}, {0, 100}};
    expect_fills({outline, {{20, 20}, {20, 40}, {40, 40}, {40, 20}}});
    Loops grid = {outline};
    for (std::int64_t u = 10; u < 90; u += 20) {
        for (std::int64_t v = 10; v < 90; v += 20) {
            grid.push_back({{u, v}, {u, v + 10}, {u + 10, v + 10}, {u + 10, v}});
        }
    }
    expect_fills(grid);
}

TEST(Triangulate, TicksAreTheNearest) {
    EXPECT_EQ(ticks(0.35), 3500);
    EXPECT_EQ(ticks(-0.1), -1000);
    EXPECT_EQ(ticks(0.1 + 0.2), ticks(0.3));
}

}  // namespace
}  // namespace earshot::scenes
