// SPDX-License-Identifier: MIT
#include "earshot/collision/penetration.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <cmath>

namespace earshot::collision {
namespace {

using geometry::Vec3;

Corners moved(Corners t, const Vec3& by) {
    for (Vec3& corner : t) {
        corner += by;
    }
    return t;
}

TEST(Penetration, MoveTakesTheTrianglesApartAndLessAlongItDoesNot) {
    int intersecting = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Corners a, b;
        for (std::size_t k = 0; k < 3; ++k) {
            a[k] = test::random_point(50, 3 * i + k);
            b[k] = test::random_point(51, 3 * i + k);
        }
        if (!intersect(a, b)) {
            continue;
        }
        ++intersecting;
        const auto found = depth(a, b);
        ASSERT_TRUE(found);
        EXPECT_NEAR(glm::length(found->move), found->depth, 1e-15);
        EXPECT_FALSE(intersect(moved(a, (1.0 + 1e-6) * found->move), b)) << i;
        // The plane that ends up between them has no smaller move.
        const Vec3 direction = found->move / found->depth;
        const auto height = [&](const Corners& t, auto pick) {
            return pick(
                {glm::dot(direction, t[0]), glm::dot(direction, t[1]), glm::dot(direction, t[2])});
        };
        const double low = height(a, [](std::initializer_list<double> x) { return std::min(x); });
        const double high = height(b, [](std::initializer_list<double> x) { return std::max(x); });
        EXPECT_NEAR(high - low, found->depth, 1e-13) << i;
    }
    EXPECT_GT(intersecting, 200);
}

TEST(Penetration, OfContactIsZero) {
    const Corners floor{Vec3{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    EXPECT_EQ(depth(floor, {Vec3{1, 1, 0}, {1, 2, 1}, {2, 1, 1}})->depth, 0.0);
    EXPECT_EQ(depth(floor, floor)->depth, 0.0);
    const Corners point{Vec3{1, 1, 0}, {1, 1, 0}, {1, 1, 0}};
    EXPECT_TRUE(depth(floor, point));
    EXPECT_FALSE(depth(point, point));
}

TEST(Penetration, IsDeepestWhereASpikeGoesThroughAFloor) {
    const geometry::Mesh floor = {{{-9, 0, -9}, {9, 0, -9}, {0, 0, 9}}, {{0, 1, 2}}};
    // Three spikes that reach 1, 3 and 2 below the floor, three triangles each of a kind.
    geometry::Mesh spikes;
    for (const double reach : {1.0, 3.0, 2.0}) {
        const auto first = static_cast<geometry::VertexId>(spikes.positions.size());
        const double x = reach - 2.0;
        spikes.positions.insert(spikes.positions.end(),
                                {{x, -reach, 0}, {x - 0.1, 5, 0}, {x + 0.1, 5, 0}});
        spikes.triangles.push_back({first, first + 1, first + 2});
    }
    const Shape a = Shape::build(spikes.view());
    const Shape b = Shape::build(floor.view());
    const auto contacts = find_contacts({a}, {b});
    ASSERT_EQ(contacts.size(), 3U);
    const auto found = deepest_penetration({a}, {b}, contacts);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->triangles, (TrianglePair{1, 0}));
    EXPECT_DOUBLE_EQ(found->depth.depth, 3.0);
    EXPECT_EQ(found->depth.move, Vec3(0, 3, 0));
    EXPECT_NEAR(found->cut.from.x, 1.0 - 0.1 * 3.0 / 8.0, 1e-12);
    auto reversed = contacts;
    std::reverse(reversed.begin(), reversed.end());
    EXPECT_EQ(deepest_penetration({a}, {b}, reversed)->triangles, found->triangles);
    EXPECT_FALSE(deepest_penetration({a}, {b}, {}));
}

}  // namespace
}  // namespace earshot::collision
