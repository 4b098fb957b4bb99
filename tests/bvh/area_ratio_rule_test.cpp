// SPDX-License-Identifier: MIT
#include "structures/area_ratio_rule.h"

#include <gtest/gtest.h>

#include <vector>

namespace bench {
namespace {

using earshot::bvh::Tree;
using earshot::geometry::Aabb;

// Lauterbach 2010, section 4.2, by hand: two unit cubes side by side, then ten apart. The node's
// half area grows from 5 to 25, that of its children stays 6 in all: (25 - 5) / 6.
TEST(AreaRatioRule, EqualsAHandExample) {
    const std::vector<Aabb> close = {{{0.0F, 0.0F, 0.0F}, {1.0F, 1.0F, 1.0F}},
                                     {{1.0F, 0.0F, 0.0F}, {2.0F, 1.0F, 1.0F}}};
    const std::vector<Aabb> apart = {close[0], {{11.0F, 0.0F, 0.0F}, {12.0F, 1.0F, 1.0F}}};
    Tree tree = Tree::build(close, {.max_leaf_size = 1});
    const AreaRatioRule rule(tree);
    EXPECT_EQ(rule.growth(tree), 0.0);
    tree.refit(apart);
    EXPECT_NEAR(rule.growth(tree), 20.0 / 6.0, 1e-6);
    EXPECT_GT(rule.growth(tree), AreaRatioRule::kThreshold);
}

}  // namespace
}  // namespace bench
