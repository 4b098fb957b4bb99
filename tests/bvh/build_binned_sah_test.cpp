// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/tree_walker.h"
#include <cmath>
#include <cstring>
#include <string>

namespace earshot::bvh {
namespace {

using geometry::Aabb;
using geometry::Vec3;

bool same_bits(const Tree& a, const Tree& b) {
    return a.nodes().size() == b.nodes().size() &&
           std::memcmp(a.nodes().data(), b.nodes().data(), a.nodes().size_bytes()) == 0 &&
           std::equal(a.primitives().begin(),
                      a.primitives().end(),
                      b.primitives().begin(),
                      b.primitives().end());
}

TEST(BuildSah, MakesASoundTreeForEveryLeafSize) {
    const auto mesh = test::triangle_soup(1, 5000);
    const auto boxes = triangle_boxes(mesh.view());
    for (const int leaf_size : {1, 2, 4, 15}) {
        const Tree tree = Tree::build(boxes, {.leaf_size = leaf_size});
        EXPECT_EQ(test::fault_of(tree, boxes, static_cast<std::size_t>(leaf_size)), "")
            << leaf_size;
    }
}

TEST(BuildSah, DoesNotDependOnTheNumberOfThreads) {
    const auto boxes = triangle_boxes(test::triangle_soup(2, 50000).view());
    const Tree expected = Tree::build(boxes);
    EXPECT_EQ(test::fault_of(expected, boxes, 4), "");
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        EXPECT_TRUE(same_bits(Tree::build(boxes, {}, executor), expected)) << threads;
    }
}

TEST(BuildSah, DoesNotDependOnTheInstructionSet) {
    const auto boxes = triangle_boxes(test::triangle_soup(3, 30000).view());
    for (const int leaf_size : {1, 4, 15}) {
        const BuildOptions options{.leaf_size = leaf_size};
        const Tree expected = Tree::build(boxes, options);
        for (const std::string& target : simd_targets()) {
            use_simd_target(target);
            const Tree tree = Tree::build(boxes, options);
            use_simd_target("auto");
            EXPECT_TRUE(same_bits(tree, expected)) << target << ' ' << leaf_size;
        }
    }
}

TEST(BuildSah, CostsFarLessThanHalvingByIndex) {
    const auto mesh = test::sphere(5, 1.0, Vec3(0.0));
    const auto boxes = triangle_boxes(mesh.view());
    // A sphere's tree is good if a ray that hits its box meets few leaves: about 2 surfaces with a
    // handful of nodes on each level.
    EXPECT_LT(sah_cost(Tree::build(boxes)), 40.0);
    EXPECT_GT(sah_cost(Tree::build(boxes)), 5.0);
}

TEST(BuildSah, HandlesNoBoxAndOneBox) {
    EXPECT_TRUE(Tree::build({}).nodes().empty());
    const std::vector<Aabb> one = {geometry::Aabb{{0, 0, 0}, {1, 1, 1}}};
    const Tree tree = Tree::build(one);
    ASSERT_EQ(tree.nodes().size(), 1U);
    EXPECT_TRUE(tree.nodes()[0].is_leaf());
}

TEST(BuildSah, StaysShallowWhateverTheBoxes) {
    constexpr std::size_t kCount = 20000;
    std::vector<Aabb> same(kCount, Aabb{{1, 2, 3}, {4, 5, 6}});
    std::vector<Aabb> exponential, line, huge;
    for (std::size_t i = 0; i < kCount; ++i) {
        const float x = std::exp2(static_cast<float>(i % 250) - 125.0F);
        exponential.push_back({{x, x, x}, {2 * x, 2 * x, 2 * x}});
        const auto y = static_cast<float>(i);
        line.push_back({{y, 0, 0}, {y, 0, 0}});
        huge.push_back({{-3e38F, -3e38F, -3e38F}, {3e38F, 3e38F, i % 2 == 0 ? 3e38F : 2e38F}});
    }
    for (const auto& boxes : {same, exponential, line, huge}) {
        EXPECT_EQ(test::fault_of(Tree::build(boxes), boxes, 4), "");
    }
}

TEST(BuildSah, RefusesOptionsOutOfRange) {
    const std::vector<Aabb> one = {Aabb{{0, 0, 0}, {1, 1, 1}}};
    EXPECT_THROW(Tree::build(one, {.leaf_size = 0}), Error);
    EXPECT_THROW(Tree::build(one, {.leaf_size = 16}), Error);
    EXPECT_THROW(Tree::build(one, {.traversal_cost = -1.0}), Error);
    EXPECT_THROW(Tree::build(one, {.traversal_cost = std::nan("")}), Error);
}

}  // namespace
}  // namespace earshot::bvh
