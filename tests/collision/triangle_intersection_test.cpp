// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hard_triangles.h"
#include "support/meshes.h"

namespace earshot::collision {
namespace {

using geometry::Segment;
using geometry::Vec3;

Corners turned(const Corners& t) {
    return {t[2], t[0], t[1]};
}
Corners reversed(const Corners& t) {
    return {t[1], t[0], t[2]};
}

Corners random_triangle(std::uint64_t seed, std::uint64_t i) {
    return {test::random_point(seed, 3 * i),
            test::random_point(seed, 3 * i + 1),
            test::random_point(seed, 3 * i + 2)};
}

TEST(Meet, IsExactForHardPairs) {
    int intersecting = 0;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        const test::WholePair pair = test::hard_pair(1, i);
        const bool expected = test::meet_exactly(pair.one, pair.other);
        const auto [a, b] = pair.scaled(static_cast<int>(random_bits(2, 0, i) % 81) - 60);
        ASSERT_EQ(intersect(a, b), expected) << "pair " << i;
        ASSERT_EQ(intersect(b, a), expected) << "pair " << i;
        ASSERT_EQ(intersect(turned(a), reversed(b)), expected) << "pair " << i;
        ASSERT_EQ(intersect(reversed(a), turned(b)), expected) << "pair " << i;
        intersecting += expected ? 1 : 0;
    }
    EXPECT_GT(intersecting, 800);
    EXPECT_LT(intersecting, 3200);
}

TEST(Meet, SeesTheLastBit) {
    const Corners floor{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_TRUE(intersect(floor, {Vec3{0.25, 0.25, 0}, {0, 0, 1}, {1, 0, 1}}));
    EXPECT_FALSE(intersect(floor, {Vec3{0.25, 0.25, 1e-80}, {0, 0, 1}, {1, 0, 1}}));
    EXPECT_TRUE(intersect(floor, {Vec3{0.5, 0.5, -1}, {0.5, 0.5, 1}, {1, 1, 0}}));
    const double beyond = std::nextafter(0.5, 1.0);
    EXPECT_FALSE(intersect(floor, {Vec3{0.5, beyond, -1}, {0.5, beyond, 1}, {1, 1, 0}}));
}

/// Where the border of one passes through the inside of the other, in extended precision.
std::vector<Vec3> piercings(const Corners& one, const Corners& other) {
    using Wide = glm::vec<3, long double>;
    const Wide origin(other[0]);
    const Wide u = Wide(other[1]) - origin;
    const Wide v = Wide(other[2]) - origin;
    const Wide n = glm::cross(u, v);
    std::vector<Vec3> found;
    for (std::size_t i = 0; i < 3; ++i) {
        const Wide from(one[i]);
        const Wide to(one[(i + 1) % 3]);
        const long double start = glm::dot(n, from - origin);
        const long double end = glm::dot(n, to - origin);
        if (start * end > 0.0L) {
            continue;
        }
        const Wide at = from + start / (start - end) * (to - from);
        const long double second = glm::dot(glm::cross(at - origin, v), n) / glm::dot(n, n);
        const long double third = glm::dot(glm::cross(u, at - origin), n) / glm::dot(n, n);
        if (second >= 0.0L && third >= 0.0L && second + third <= 1.0L) {
            found.emplace_back(at);
        }
    }
    return found;
}

TEST(Intersection, IsWhereBordersPierceTheOther) {
    int intersecting = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const Corners a = random_triangle(3, i);
        const Corners b = random_triangle(4, i);
        auto expected = piercings(a, b);
        const auto more = piercings(b, a);
        expected.insert(expected.end(), more.begin(), more.end());
        const auto found = intersection(a, b);
        ASSERT_EQ(found.has_value(), !expected.empty()) << "pair " << i;
        if (!found) {
            continue;
        }
        ++intersecting;
        ASSERT_EQ(expected.size(), 2U) << "pair " << i;
        if (expected[1].x < expected[0].x) {
            std::swap(expected[0], expected[1]);
        }
        // 2^-36 of the longest edge, which is below 4.
        EXPECT_LT(glm::length(found->from - expected[0]), 0x1p-34) << "pair " << i;
        EXPECT_LT(glm::length(found->to - expected[1]), 0x1p-34) << "pair " << i;
    }
    EXPECT_GT(intersecting, 300);
}

TEST(Intersection, IsThereExactlyWhereTrianglesMeet) {
    for (std::uint64_t i = 0; i < 4000; ++i) {
        const auto [a, b] = test::hard_pair(5, i).scaled(-10);
        const auto found = intersection(a, b);
        ASSERT_EQ(found.has_value(), intersect(a, b)) << "pair " << i;
        if (!found) {
            continue;
        }
        for (const Vec3& point : {found->from, found->to}) {
            for (const Corners& triangle : {a, b}) {
                EXPECT_LT(test::feature_distance({point, point, point}, triangle), 1024.0 * 0x1p-34)
                    << "pair " << i;
            }
        }
    }
}

TEST(Intersection, SpansThePolygonOfTrianglesInOnePlane) {
    const Corners a{Vec3{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    // The shared polygon has the corners (1, 1), (3, 1), (1, 3).
    const auto found = intersection(a, {Vec3{1, 1, 0}, {5, 1, 0}, {1, 5, 0}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->from, Vec3(1, 3, 0));
    EXPECT_EQ(found->to, Vec3(3, 1, 0));
}

TEST(Intersection, OfACornerThatTouchesIsThatCorner) {
    const Corners a{Vec3{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto found = intersection(a, {Vec3{1, 1, 0}, {1, 1, 5}, {2, 1, 5}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->from, Vec3(1, 1, 0));
    EXPECT_EQ(found->to, Vec3(1, 1, 0));
}

}  // namespace
}  // namespace earshot::collision
