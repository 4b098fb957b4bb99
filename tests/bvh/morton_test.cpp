// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/morton.h"

#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Aabb;

Aabb point(float x, float y, float z) {
    return {{x, y, z}, {x, y, z}};
}

std::vector<std::uint32_t> order_of(const std::vector<Aabb>& boxes) {
    std::vector<std::uint32_t> order;
    for (const MortonPrimitive& primitive : sorted_by_morton_code(boxes, Executor::serial())) {
        order.push_back(primitive.index);
    }
    return order;
}

// The corners of a cube: x counts most, z least.
TEST(Morton, OrdersTheCornersOfACube) {
    std::vector<Aabb> corners;
    for (int i = 7; i >= 0; --i) {
        corners.push_back(point(static_cast<float>(i >> 2 & 1),
                                static_cast<float>(i >> 1 & 1),
                                static_cast<float>(i & 1)));
    }
    EXPECT_EQ(order_of(corners), (std::vector<std::uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(Morton, KeepsTheOrderOfWhatCoincides) {
    const std::vector<Aabb> boxes = {
        point(1.0F, 1.0F, 1.0F), point(0.0F, 0.0F, 0.0F), point(1.0F, 1.0F, 1.0F)};
    EXPECT_EQ(order_of(boxes), (std::vector<std::uint32_t>{1, 0, 2}));
    const std::vector<Aabb> same(5, point(2.0F, 3.0F, 4.0F));
    EXPECT_EQ(order_of(same), (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

TEST(Morton, SortsAsComparingCodesDoes) {
    const auto mesh = test::triangle_soup(3, 150000);
    const auto boxes = triangle_boxes(mesh.view());
    Executor two(2);
    const auto primitives = sorted_by_morton_code(boxes, two);
    EXPECT_TRUE(std::is_sorted(primitives.begin(),
                               primitives.end(),
                               [](const MortonPrimitive& a, const MortonPrimitive& b) {
                                   return a.code != b.code ? a.code < b.code : a.index < b.index;
                               }));
    const auto again = sorted_by_morton_code(boxes, Executor::serial());
    EXPECT_TRUE(std::equal(
        primitives.begin(), primitives.end(), again.begin(), [](const auto& a, const auto& b) {
            return a.code == b.code && a.index == b.index;
        }));
}

TEST(Morton, SplitsWhereTheHighestDifferingBitTurns) {
    const std::vector<MortonPrimitive> primitives = {
        {0, 0}, {3, 1}, {4, 2}, {5, 3}, {5, 4}, {5, 5}};
    const std::span run(primitives);
    EXPECT_EQ(curve_split(run), 2U);
    EXPECT_EQ(curve_split(run.subspan(2)), 1U);
    EXPECT_EQ(curve_split(run.subspan(3)), 1U);  // equal: the middle
}

// All bits are of the one side that is not flat, and points at equal distances keep their order.
TEST(Morton, HalvesTheLongestSide) {
    std::vector<Aabb> line, sheet;
    for (int i = 0; i < 1024; ++i) {
        line.push_back(point(0.0F, static_cast<float>(1023 - i), 0.0F));
        sheet.push_back(point(static_cast<float>(i % 2), 0.0F, static_cast<float>(1023 - i)));
    }
    for (const auto& boxes : {line, sheet}) {
        const auto sorted = sorted_by_morton_code(boxes, Executor::serial());
        for (std::uint32_t i = 0; i < 1024; ++i) {
            EXPECT_EQ(sorted[i].index, 1023 - i);
        }
    }
}

// An object of thousands of primitives in one cell of the scene's grid is divided as if it were
// alone.
TEST(Morton, GivesASmallPartOfALargeSceneCodesOfItsOwn) {
    constexpr std::uint32_t kPoints = 8192;
    std::vector<Aabb> boxes = {point(1e9F, 1e9F, 1e9F)};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        boxes.push_back(point(static_cast<float>(i * 5 % kPoints), 0.0F, 0.0F));
    }
    auto sorted = sorted_by_morton_code(boxes, Executor::serial());
    ASSERT_EQ(sorted.front().code, sorted[kPoints - 1].code);
    MortonRange range = {0, kPoints};
    EXPECT_EQ(split_morton_range(boxes, sorted, range, Executor::serial()), kPoints / 2);
    EXPECT_FALSE(range.is_one_point);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        EXPECT_EQ(boxes[sorted[i].index].lower[0], static_cast<float>(i));
    }
}

TEST(Morton, HalvesWhatCoincides) {
    const std::vector<Aabb> boxes(10000, point(1.0F, 2.0F, 3.0F));
    auto sorted = sorted_by_morton_code(boxes, Executor::serial());
    MortonRange range = {0, 10000};
    EXPECT_EQ(split_morton_range(boxes, sorted, range, Executor::serial()), 5000U);
    EXPECT_TRUE(range.is_one_point);
}

}  // namespace
}  // namespace earshot::bvh
