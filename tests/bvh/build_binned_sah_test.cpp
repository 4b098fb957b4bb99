// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <bit>
#include <cmath>

namespace earshot::bvh {
namespace {

using geometry::Aabb;
using geometry::Vec3;

TEST(BuildBinnedSah, CostsFarLessThanMedianSplitsByIndex) {
    const auto mesh = test::sphere(5, 1.0, Vec3(0.0));
    const auto boxes = triangle_boxes(mesh.view());
    // A sphere's tree is good if a ray that hits its box meets few leaves: about 2 surfaces with a
    // handful of nodes on each level.
    EXPECT_LT(sah_cost(Tree::build(boxes)), 40.0);
    EXPECT_GT(sah_cost(Tree::build(boxes)), 5.0);
}

/// What the cheapest of all trees over the chosen boxes costs, times the half area of its root.
double cheapest_tree(const std::vector<Aabb>& boxes, unsigned chosen, const BuildOptions& options) {
    Aabb box;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if ((chosen >> i & 1U) != 0) {
            box.include(boxes[i]);
        }
    }
    const int count = std::popcount(chosen);
    if (count == 1) {
        return box.half_area();
    }
    double best = std::numeric_limits<double>::infinity();
    for (unsigned left = (chosen - 1) & chosen; left != 0; left = (left - 1) & chosen) {
        best = std::min(best,
                        options.traversal_cost * box.half_area() +
                            cheapest_tree(boxes, left, options) +
                            cheapest_tree(boxes, chosen & ~left, options));
    }
    return count <= options.max_leaf_size ? std::min(best, count * box.half_area()) : best;
}

TEST(BuildBinnedSah, FindsTheCheapestTreeOverUpToFourBoxes) {
    constexpr double kSingle = 1e-5;  // costs are compared in single precision
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const auto boxes = triangle_boxes(test::triangle_soup(seed, 1 + seed % 4).view());
        for (const int max_leaf_size : {1, 2, 3, 4}) {
            const BuildOptions options{.max_leaf_size = max_leaf_size,
                                       .traversal_cost = static_cast<double>(seed % 3)};
            const Tree tree = Tree::build(boxes, options);
            const double cost = sah_cost(tree, options.traversal_cost);
            const unsigned all = (1U << boxes.size()) - 1;
            const double best =
                cheapest_tree(boxes, all, options) / tree.nodes().front().box.half_area();
            EXPECT_NEAR(cost, best, kSingle * best) << seed << ' ' << max_leaf_size;
        }
    }
}

TEST(BuildBinnedSah, HandlesNoBoxAndOneBox) {
    EXPECT_TRUE(Tree::build({}).nodes().empty());
    const std::vector<Aabb> one = {Aabb{{0, 0, 0}, {1, 1, 1}}};
    const Tree tree = Tree::build(one);
    ASSERT_EQ(tree.nodes().size(), 1U);
    EXPECT_TRUE(tree.nodes()[0].is_leaf());
}

TEST(BuildOptions, OutOfRangeAreRefused) {
    const std::vector<Aabb> one = {Aabb{{0, 0, 0}, {1, 1, 1}}};
    EXPECT_THROW(Tree::build(one, {.max_leaf_size = 0}), Error);
    EXPECT_THROW(Tree::build(one, {.max_leaf_size = 16}), Error);
    EXPECT_THROW(Tree::build(one, {.traversal_cost = -1.0}), Error);
    EXPECT_THROW(Tree::build(one, {.traversal_cost = std::nan("")}), Error);
}

}  // namespace
}  // namespace earshot::bvh
