// SPDX-License-Identifier: MIT
#include "earshot/bvh/builder_names.h"
#include "earshot/bvh/quality.h"

#include <gtest/gtest.h>

#include "bvh/tree_bits.h"
#include "support/bunny.h"
#include "support/meshes.h"
#include "support/tree_walker.h"
#include <cmath>
#include <string>
#include <utility>

// What every builder keeps.

namespace earshot::bvh {
namespace {

using geometry::Aabb;

std::vector<Builder> all_builders() {
    std::vector<Builder> builders;
    for (const NamedBuilder& named : named_builders()) {
        builders.push_back(named.builder);
    }
    return builders;
}

class EveryBuilder : public testing::TestWithParam<Builder> {};

TEST_P(EveryBuilder, MakesASoundTreeForEveryLeafSize) {
    const auto boxes = triangle_boxes(test::triangle_soup(1, 5000).view());
    for (int max_leaf_size = 1; max_leaf_size <= 15; ++max_leaf_size) {
        for (const double traversal_cost : {0.0, 1.0, 1e6}) {
            const Tree tree = Tree::build(boxes,
                                          {.builder = GetParam(),
                                           .max_leaf_size = max_leaf_size,
                                           .traversal_cost = traversal_cost});
            EXPECT_EQ(test::fault_of(tree, boxes, static_cast<std::size_t>(max_leaf_size)), "")
                << max_leaf_size << ' ' << traversal_cost;
        }
    }
}

TEST_P(EveryBuilder, MakesASoundTreeOfFewBoxes) {
    for (std::size_t count = 0; count < 40; ++count) {
        const auto boxes = triangle_boxes(test::triangle_soup(count, count).view());
        EXPECT_EQ(test::fault_of(Tree::build(boxes, {.builder = GetParam()}), boxes, 4), "")
            << count;
    }
}

TEST_P(EveryBuilder, DoesNotDependOnThreadsOrTheInstructionSet) {
    const auto boxes = triangle_boxes(test::triangle_soup(2, 40000).view());
    for (const int max_leaf_size : {1, 4}) {
        expect_the_same_tree_everywhere(boxes,
                                        {.builder = GetParam(), .max_leaf_size = max_leaf_size});
    }
}

TEST_P(EveryBuilder, StaysShallowWhateverTheBoxes) {
    constexpr std::size_t kCount = 20000;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<Aabb> same(kCount, Aabb{{1, 2, 3}, {4, 5, 6}});
    std::vector<Aabb> exponential, line, huge, endless, zeros, concentric;
    for (std::size_t i = 0; i < kCount; ++i) {
        const float x = std::exp2(static_cast<float>(i % 250) - 125.0F);
        exponential.push_back({{x, x, x}, {2 * x, 2 * x, 2 * x}});
        concentric.push_back({{-x, -x, -x}, {x, x, x}});
        const auto y = static_cast<float>(i);
        line.push_back({{y, 0, 0}, {y, 0, 0}});
        huge.push_back({{-3e38F, -3e38F, -3e38F}, {3e38F, 3e38F, i % 2 == 0 ? 3e38F : 2e38F}});
        endless.push_back({{-kInfinity, y, i % 3 == 0 ? -kInfinity : y}, {y, kInfinity, y}});
        zeros.push_back({{-0.0F, 0.0F, -y}, {0.0F, -0.0F, y}});
    }
    for (const auto& boxes : {same, exponential, line, huge, endless, zeros, concentric}) {
        EXPECT_EQ(test::fault_of(Tree::build(boxes, {.builder = GetParam()}), boxes, 4), "");
    }
}

TEST_P(EveryBuilder, SeparatesWhatLiesApart) {
    // Two clusters at the ends of a line, in mixed order: no child of the root holds both.
    std::vector<Aabb> boxes;
    for (int i = 0; i < 64; ++i) {
        const auto x = static_cast<float>((i % 2 == 0 ? 0 : 1000) + i);
        boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
    }
    const Tree tree = Tree::build(boxes, {.builder = GetParam()});
    const Node& left = tree.nodes()[1];
    const Node& right = tree.nodes()[2];
    EXPECT_LT(left.box.upper[0] - left.box.lower[0], 100.0F);
    EXPECT_LT(right.box.upper[0] - right.box.lower[0], 100.0F);
}

INSTANTIATE_TEST_SUITE_P(Bvh,
                         EveryBuilder,
                         testing::ValuesIn(all_builders()),
                         [](const testing::TestParamInfo<Builder>& chosen) {
                             return std::string(
                                 named_builders()[static_cast<std::size_t>(chosen.param)].name);
                         });

TEST(BuilderNames, StandInTheOrderOfTheEnumeration) {
    for (std::size_t i = 0; i < named_builders().size(); ++i) {
        const NamedBuilder& named = named_builders()[i];
        EXPECT_EQ(static_cast<std::size_t>(named.builder), i);
        ASSERT_TRUE(builder_named(named.name).has_value());
        EXPECT_EQ(builder_named(named.name)->builder, named.builder);
        EXPECT_FALSE(named.summary.empty());
    }
    EXPECT_FALSE(builder_named("").has_value());
    EXPECT_EQ(named_builders().front().builder, BuildOptions{}.builder);
}

TEST(Builders, OfTheHeuristicCostAboutTheSameAndTheMedianMore) {
    const auto cost = [](const std::vector<Aabb>& boxes, Builder builder) {
        return sah_cost(Tree::build(boxes, {.builder = builder}));
    };
    std::vector<std::vector<Aabb>> scenes = {triangle_boxes(test::triangle_soup(5, 20000).view()),
                                             triangle_boxes(test::cube(40, 1.0).view())};
    const geometry::Mesh bunny = test::stanford_bunny();
    if (!bunny.triangles.empty()) {
        scenes.push_back(triangle_boxes(bunny.view()));
    }
    for (const auto& boxes : scenes) {
        const double binned = cost(boxes, Builder::binned_sah);
        const double swept = cost(boxes, Builder::sweep_sah);
        EXPECT_LT(swept, 1.02 * binned);
        EXPECT_LT(binned, 1.1 * swept);  // 7 % in the soup, whose boxes overlap everywhere
        EXPECT_GT(cost(boxes, Builder::spatial_median), binned);
    }
}

}  // namespace
}  // namespace earshot::bvh
