// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/changed_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using Meshes = std::vector<std::uint32_t>;

std::vector<Vec3> triangle_at(double x) {
    return {{x, 0.0, 0.0}, {x + 1.0, 0.0, 0.0}, {x, 1.0, 0.0}};
}

TEST(ChangedMeshes, AreThoseThatMoveOtherwiseThanAtTheLastCall) {
    MovingScene scene;
    const std::vector<Triangle> triangle{{0, 1, 2}};
    for (int i = 0; i < 3; ++i) {
        scene.add(triangle, 3);
    }
    ChangedMeshes changed, seldom_asked;
    EXPECT_EQ(changed.take(scene), (Meshes{0, 1, 2}));
    EXPECT_EQ(changed.take(scene), Meshes{});
    EXPECT_TRUE(scene.move(1, triangle_at(2.0), triangle_at(2.0)));
    EXPECT_EQ(changed.take(scene), Meshes{1});
    // At rest where it was.
    EXPECT_FALSE(scene.move(1, triangle_at(2.0), triangle_at(2.0)));
    EXPECT_EQ(changed.take(scene), Meshes{});
    // It begins there again but ends elsewhere.
    EXPECT_FALSE(scene.move(1, triangle_at(2.0), triangle_at(3.0)));
    EXPECT_EQ(changed.take(scene), Meshes{1});
    // Onto a screw, along it once more, and off it.
    const Screw screw{.angle = 0.1};
    for (int i = 0; i < 2; ++i) {
        scene.move(2, triangle_at(0.0), screw);
        EXPECT_EQ(changed.take(scene), Meshes{2});
    }
    scene.move(2, triangle_at(0.0), triangle_at(0.0));
    EXPECT_EQ(changed.take(scene), Meshes{2});
    EXPECT_EQ(seldom_asked.take(scene), (Meshes{0, 1, 2}));
    changed.reset();
    EXPECT_EQ(changed.take(scene), (Meshes{0, 1, 2}));
}

TEST(ChangedMeshes, TheSignOfAZeroIsAChange) {
    MovingScene scene;
    scene.add(std::vector<Triangle>{{0, 1, 2}}, 3);
    const std::vector<Vec3> here = triangle_at(0.0);
    std::vector<Vec3> there = here;
    there[0].x = -0.0;
    scene.move(0, here, here);
    // Tiny coordinates may lose their sign on the way; then nothing has changed.
    EXPECT_EQ(scene.move(0, there, there), std::signbit(scene.begin[0].x));
}

TEST(IndexRanges, AreVisitedOnceEachInAnyChunks) {
    const std::vector<IndexRange> ranges = joined({{20, 25}, {3, 3}, {7, 11}, {0, 5}, {5, 7}});
    ASSERT_EQ(ranges.size(), 2U);
    EXPECT_EQ(ranges[0].begin, 0U);
    EXPECT_EQ(ranges[0].end, 11U);
    EXPECT_EQ(ranges[1].begin, 20U);
    for (const std::size_t grain : {1U, 2U, 3U, 7U, 100U}) {
        Executor executor(2);
        std::vector<int> visits(30);
        for_each_index(ranges, grain, executor, [&](std::uint32_t i) { ++visits[i]; });
        for (std::size_t i = 0; i < visits.size(); ++i) {
            EXPECT_EQ(visits[i], i < 11 || (i >= 20 && i < 25) ? 1 : 0) << i << " " << grain;
        }
    }
    for_each_index({}, 4, Executor::serial(), [](std::uint32_t) { FAIL(); });
}

}  // namespace
}  // namespace earshot::collision
