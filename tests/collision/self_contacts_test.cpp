// SPDX-License-Identifier: MIT
#include "earshot/collision/discrete.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <algorithm>

namespace earshot::collision {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using geometry::Vec3;

std::vector<TrianglePair> contacts_of(const Mesh& mesh) {
    const Shape shape = Shape::build(mesh.view());
    Executor two(2);
    const auto found = find_self_contacts({shape});
    EXPECT_EQ(find_self_contacts({shape}, two), found);
    return found;
}

bool share_a_vertex(const Triangle& a, const Triangle& b) {
    return std::any_of(a.begin(), a.end(), [&](geometry::VertexId id) {
        return std::find(b.begin(), b.end(), id) != b.end();
    });
}

TEST(SelfContacts, AreAllPairsThatMeetAmongThoseWithoutCommonVertices) {
    for (std::uint64_t seed = 1; seed < 6; ++seed) {
        const Mesh mesh = test::degenerate_soup(seed, 400);
        const auto corners = [&](std::size_t i) {
            const auto& [a, b, c] = mesh.triangles[i];
            return Corners{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
        };
        std::vector<TrianglePair> expected;
        for (geometry::TriangleId i = 0; i < mesh.triangles.size(); ++i) {
            for (geometry::TriangleId k = i + 1; k < mesh.triangles.size(); ++k) {
                if (!share_a_vertex(mesh.triangles[i], mesh.triangles[k]) &&
                    intersect(corners(i), corners(k))) {
                    expected.push_back({i, k});
                }
            }
        }
        auto found = contacts_of(mesh);
        std::erase_if(found, [&](const TrianglePair& pair) {
            return share_a_vertex(mesh.triangles[pair.a], mesh.triangles[pair.b]);
        });
        EXPECT_EQ(found, expected) << seed;
        EXPECT_GT(expected.size(), 20U) << seed;
    }
}

TEST(SelfContacts, AreNoneOnClosedSurfaces) {
    EXPECT_TRUE(contacts_of(test::sphere(4, 1.0, {0.1, 0.2, 0.3})).empty());
    EXPECT_TRUE(contacts_of(test::cube(7, 0.3)).empty());
}

/// Two triangles with common vertices, the first in the floor.
bool meet_as_neighbours(const std::vector<Vec3>& positions, const Triangle& other) {
    const Mesh mesh{positions, {{0, 1, 2}, other}};
    const auto found = contacts_of(mesh);
    Mesh turned = mesh;
    std::rotate(
        turned.triangles[0].begin(), turned.triangles[0].begin() + 1, turned.triangles[0].end());
    std::swap(turned.triangles[1][0], turned.triangles[1][1]);
    std::swap(turned.triangles[0], turned.triangles[1]);
    EXPECT_EQ(contacts_of(turned), found);
    return !found.empty();
}

TEST(SelfContacts, OfTrianglesWithOneVertexInCommonNeedAnotherPoint) {
    const std::vector<Vec3> floor = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Vec3& d, const Vec3& e) {
        auto positions = floor;
        positions.push_back(d);
        positions.push_back(e);
        return meet_as_neighbours(positions, {0, 3, 4});
    };
    EXPECT_FALSE(with({-1, 0, 1}, {0, -1, 1}));
    EXPECT_FALSE(with({1, 1, 1}, {1, 2, 1}));    // above, from the corner up
    EXPECT_TRUE(with({1, 1, 1}, {1, 1, -1}));    // through it
    EXPECT_TRUE(with({1, 1, 0}, {1, 1, 1}));     // with an edge in it
    EXPECT_TRUE(with({2, 0, 0}, {0, -1, 0}));    // along its border
    EXPECT_FALSE(with({-1, 0, 0}, {0, -1, 0}));  // in its plane, on the other side
    EXPECT_TRUE(with({9, 8, 1}, {9, 8, -1}));    // out through its far edge
    EXPECT_FALSE(with({1, 1, 0x1p-60}, {1, 1, 1}));
}

TEST(SelfContacts, OfTrianglesWithAnEdgeInCommonNeedAnArea) {
    const std::vector<Vec3> floor = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Vec3& d) {
        auto positions = floor;
        positions.push_back(d);
        return meet_as_neighbours(positions, {1, 0, 3});
    };
    EXPECT_FALSE(with({0, -4, 0}));
    EXPECT_FALSE(with({1, 1, 1}));
    EXPECT_TRUE(with({1, 1, 0}));
    EXPECT_TRUE(with({9, 9, 0}));
    EXPECT_FALSE(with({1, 1, 0x1p-60}));
}

TEST(SelfContacts, CountCopiesAndLeaveOutWhatHasNoArea) {
    const std::vector<Vec3> floor = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}};
    EXPECT_TRUE(meet_as_neighbours(floor, {2, 1, 0}));
    EXPECT_FALSE(meet_as_neighbours(floor, {0, 3, 3}));
}

}  // namespace
}  // namespace earshot::collision
