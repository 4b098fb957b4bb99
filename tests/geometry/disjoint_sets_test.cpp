// SPDX-License-Identifier: MIT
#include "earshot/geometry/disjoint_sets.h"

#include <gtest/gtest.h>

#include <vector>

namespace earshot::geometry {
namespace {

TEST(DisjointSets, TheLeastNumberStandsForItsSet) {
    DisjointSets sets(5);
    EXPECT_TRUE(sets.unite(4, 2));
    EXPECT_TRUE(sets.unite(3, 4));
    EXPECT_FALSE(sets.unite(2, 3));
    EXPECT_EQ(sets.find(4), 2U);
    EXPECT_EQ(sets.find(3), 2U);
    EXPECT_EQ(sets.find(0), 0U);
    sets.add();
    EXPECT_EQ(sets.find(5), 5U);
    EXPECT_TRUE(sets.unite(5, 0));
    EXPECT_EQ(sets.find(5), 0U);
}

TEST(DisjointSets, EqualRelabellingEveryMemberAtEachUnion) {
    constexpr std::uint32_t kCount = 60;
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        DisjointSets sets(kCount);
        std::vector<std::uint32_t> label(kCount);
        for (std::uint32_t i = 0; i < kCount; ++i) {
            label[i] = i;
        }
        std::uint32_t state = seed;
        const auto next = [&] { return (state = state * 1664525U + 1013904223U) >> 8U; };
        for (int step = 0; step < 40; ++step) {
            const std::uint32_t a = next() % kCount, b = next() % kCount;
            const std::uint32_t low = std::min(label[a], label[b]);
            const std::uint32_t high = std::max(label[a], label[b]);
            EXPECT_EQ(sets.unite(a, b), low != high) << seed;
            for (std::uint32_t& of : label) {
                of = of == high ? low : of;
            }
        }
        for (std::uint32_t i = 0; i < kCount; ++i) {
            EXPECT_EQ(sets.find(i), label[i]) << seed;
        }
    }
}

}  // namespace
}  // namespace earshot::geometry
