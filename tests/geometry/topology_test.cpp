// SPDX-License-Identifier: MIT
#include "earshot/geometry/topology.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace earshot::geometry {
namespace {

TEST(HalfEdges, GoRoundTheirTriangle) {
    const std::vector<Triangle> triangles{{7, 8, 9}, {4, 5, 6}};
    EXPECT_EQ(start_of(triangles, 3), 4U);
    EXPECT_EQ(end_of(triangles, 3), 5U);
    EXPECT_EQ(end_of(triangles, 5), 4U);
    EXPECT_EQ(next_in_triangle(3), 4U);
    EXPECT_EQ(next_in_triangle(5), 3U);
    EXPECT_EQ(triangle_of(5), 1U);
}

TEST(EdgeTable, HoldsEveryHalfEdgeOnceUnderItsVertices) {
    constexpr std::uint64_t kSeed = 3;
    constexpr std::size_t kVertices = 30;
    std::vector<Triangle> triangles;
    for (std::uint64_t t = 0; t < 300; ++t) {
        const auto a = static_cast<VertexId>(random_bits(kSeed, 0, t) % kVertices);
        const auto b = static_cast<VertexId>((a + 1 + random_bits(kSeed, 1, t) % 14) % kVertices);
        const auto c = static_cast<VertexId>((b + 1 + random_bits(kSeed, 2, t) % 14) % kVertices);
        triangles.push_back({a, b, c});
    }
    std::map<std::pair<VertexId, VertexId>, std::set<HalfEdgeId>> want;
    for (HalfEdgeId h = 0; h < 3 * triangles.size(); ++h) {
        want[std::minmax(start_of(triangles, h), end_of(triangles, h))].insert(h);
    }
    const EdgeTable edges(triangles, kVertices);
    ASSERT_EQ(edges.size(), want.size());
    std::size_t e = 0;
    for (const auto& [vertices, uses] : want) {
        EXPECT_TRUE(
            std::equal(uses.begin(), uses.end(), edges.uses(e).begin(), edges.uses(e).end()))
            << e;
        ++e;
    }
}

TEST(EdgeTable, IsEmptyForNoTriangles) {
    EXPECT_EQ(EdgeTable({}, 5).size(), 0U);
    EXPECT_EQ(EdgeTable({}, 0).size(), 0U);
}

TEST(Twins, JoinTwoTrianglesOfTheSameWinding) {
    const std::vector<Triangle> triangles{{0, 1, 2}, {2, 1, 3}};
    const auto twins = twins_of(EdgeTable(triangles, 4), triangles);
    EXPECT_EQ(twins[1], 3U);
    EXPECT_EQ(twins[3], 1U);
    EXPECT_EQ(std::count(twins.begin(), twins.end(), kNoHalfEdge), 4);
}

TEST(Twins, LeaveOppositeWindingsAndCrowdedEdgesApart) {
    const std::vector<Triangle> opposite{{0, 1, 2}, {1, 2, 3}};
    const std::vector<Triangle> crowded{{0, 1, 2}, {2, 1, 3}, {2, 1, 4}};
    for (const auto& triangles : {opposite, crowded}) {
        const auto twins = twins_of(EdgeTable(triangles, 5), triangles);
        EXPECT_EQ(static_cast<std::size_t>(std::count(twins.begin(), twins.end(), kNoHalfEdge)),
                  twins.size());
    }
}

}  // namespace
}  // namespace earshot::geometry
