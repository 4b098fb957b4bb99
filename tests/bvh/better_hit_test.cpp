// SPDX-License-Identifier: MIT
#include "earshot/bvh/better_hit.h"

#include "earshot/bvh/instances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Hit;

Hit hit(double t, geometry::TriangleId triangle) {
    return {.triangle = triangle, .t = t};
}

TEST(BetterHit, IsTheOneOfSmallerParameter) {
    EXPECT_TRUE(better_hit(hit(1.0, 7), hit(2.0, 3)));
    EXPECT_FALSE(better_hit(hit(2.0, 3), hit(1.0, 7)));
}

TEST(BetterHit, AtTheSameParameterIsTheOneOfLowerTriangle) {
    EXPECT_TRUE(better_hit(hit(1.0, 3), hit(1.0, 7)));
    EXPECT_FALSE(better_hit(hit(1.0, 7), hit(1.0, 3)));
    EXPECT_FALSE(better_hit(hit(1.0, 3), hit(1.0, 3)));
    EXPECT_TRUE(better_hit(hit(-0.0, 3), hit(0.0, 7)));  // equal numbers
}

TEST(BetterHit, AmongInstancesTheLowerInstanceComesBeforeTheLowerTriangle) {
    const InstanceHit first = {1, hit(1.0, 9)};
    const InstanceHit second = {2, hit(1.0, 0)};
    EXPECT_TRUE(better_hit(first, second));
    EXPECT_FALSE(better_hit(second, first));
    EXPECT_TRUE(better_hit(InstanceHit{2, hit(0.5, 5)}, first));
    EXPECT_TRUE(better_hit(InstanceHit{1, hit(1.0, 8)}, first));
    EXPECT_FALSE(better_hit(first, first));
}

// A search may meet hits in any order: the best of a set is the same for all of them.
TEST(BetterHit, OrdersEveryPermutationAlike) {
    std::vector<InstanceHit> hits = {
        {0, hit(1.0, 1)}, {0, hit(1.0, 2)}, {1, hit(1.0, 0)}, {1, hit(0.5, 4)}, {2, hit(0.5, 3)}};
    const auto order = [](const InstanceHit& a, const InstanceHit& b) { return better_hit(a, b); };
    std::vector<std::size_t> index = {0, 1, 2, 3, 4};
    const std::vector<InstanceHit> expected = {hits[3], hits[4], hits[0], hits[1], hits[2]};
    do {
        std::vector<InstanceHit> sorted;
        for (const std::size_t i : index) {
            sorted.push_back(hits[i]);
        }
        std::sort(sorted.begin(), sorted.end(), order);
        ASSERT_EQ(sorted, expected);
    } while (std::next_permutation(index.begin(), index.end()));
}

}  // namespace
}  // namespace earshot::bvh
