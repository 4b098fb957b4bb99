// SPDX-License-Identifier: MIT
#include "earshot/visibility/objects.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>

namespace earshot::visibility {
namespace {

using geometry::TriangleId;

TEST(Objects, MayBeSingleTriangles) {
    const Objects objects = Objects::triangles(3);
    ASSERT_EQ(objects.size(), 3U);
    EXPECT_EQ(objects.of(2), 2U);
    ASSERT_EQ(objects.triangles_of(1).size(), 1U);
    EXPECT_EQ(objects.triangles_of(1)[0], 1U);
}

TEST(Objects, GroupsAreNoLargerThanAskedForAndHoldEveryTriangleOnce) {
    const geometry::Mesh mesh = test::triangle_soup(5, 3000);
    for (const std::size_t most : {1U, 3U, 50U, 5000U}) {
        const Objects objects = Objects::groups(mesh.view(), most);
        std::vector<int> times(mesh.triangles.size(), 0);
        std::size_t largest = 0;
        for (ObjectId object = 0; object < objects.size(); ++object) {
            const auto members = objects.triangles_of(object);
            largest = std::max(largest, members.size());
            EXPECT_TRUE(std::is_sorted(members.begin(), members.end()));
            for (const TriangleId triangle : members) {
                EXPECT_EQ(objects.of(triangle), object);
                ++times[triangle];
            }
        }
        EXPECT_LE(largest, most);
        EXPECT_EQ(std::count(times.begin(), times.end(), 1),
                  static_cast<std::ptrdiff_t>(times.size()));
        // No more groups than halves that were just too large would leave.
        EXPECT_LE(objects.size(), most == 1 ? 3000U : 3 * mesh.triangles.size() / most + 1);
    }
}

TEST(Objects, GroupsAreOfNeighbours) {
    geometry::Mesh mesh = test::sphere(2, 1.0, {0.0, 0.0, 0.0});
    const geometry::Mesh other = test::sphere(2, 1.0, {100.0, 0.0, 0.0});
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const auto& [a, b, c] : other.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
    const Objects objects = Objects::groups(mesh.view(), other.triangles.size());
    ASSERT_EQ(objects.size(), 2U);
    EXPECT_NE(objects.of(0), objects.of(static_cast<TriangleId>(other.triangles.size())));
}

TEST(Objects, OfAnEmptyMeshAreNone) {
    EXPECT_EQ(Objects::triangles(0).size(), 0U);
    EXPECT_EQ(Objects::groups({}, 10).size(), 0U);
}

TEST(Objects, RefusesMissingNumbers) {
    EXPECT_EQ(Objects(std::vector<ObjectId>{1, 0, 1}).size(), 2U);
    EXPECT_THROW(Objects(std::vector<ObjectId>{0, 2, 2}), Error);
    EXPECT_THROW(Objects(std::vector<ObjectId>{0, 3, 1}), Error);
}

}  // namespace
}  // namespace earshot::visibility
