// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace earshot::bvh {
namespace {

using geometry::Aabb;

std::vector<Aabb> five_cubes() {
    std::vector<Aabb> boxes;
    for (const float x : {0.0F, 1.0F, 2.0F, 10.0F, 11.0F}) {
        boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
    }
    return boxes;
}

TEST(SweepCosts, OfFiveCubesAreTheOnesByHand) {
    const std::array<std::uint32_t, 5> order = {0, 1, 2, 3, 4};
    std::array<double, 5> costs{};
    sweep_costs(five_cubes(), order, costs);
    // Areas times counts; half areas are half of that. Without a cut: 5 boxes in 12 x 1 x 1.
    const std::array<double, 5> by_hand = {250.0, 190.0, 146.0, 62.0, 190.0};
    for (std::size_t j = 0; j < costs.size(); ++j) {
        EXPECT_DOUBLE_EQ(2.0 * costs[j], by_hand[j]) << j;
    }
}

TEST(BuildSweepSah, SplitsFiveCubesAfterTheThird) {
    const Tree tree =
        Tree::build(five_cubes(), {.builder = Builder::sweep_sah, .traversal_cost = 0.0});
    const Node& left = tree.nodes()[1];
    const Node& right = tree.nodes()[2];
    EXPECT_EQ(left.box, (Aabb{{0, 0, 0}, {3, 1, 1}}));
    EXPECT_EQ(right.box, (Aabb{{10, 0, 0}, {12, 1, 1}}));
}

/// The cheapest cut by trying all of them, each from the start.
double cheapest_cut(const std::vector<Aabb>& boxes) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<std::size_t> order(boxes.size());
        std::iota(order.begin(), order.end(), 0U);
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return boxes[a].lower[axis] + boxes[a].upper[axis] <
                   boxes[b].lower[axis] + boxes[b].upper[axis];
        });
        for (std::size_t j = 1; j < order.size(); ++j) {
            std::array<Aabb, 2> sides;
            for (std::size_t i = 0; i < order.size(); ++i) {
                sides[i < j ? 0 : 1].include(boxes[order[i]]);
            }
            best = std::min(best,
                            static_cast<double>(j) * sides[0].half_area() +
                                static_cast<double>(order.size() - j) * sides[1].half_area());
        }
    }
    return best;
}

std::size_t primitives_below(const Tree& tree, std::uint32_t index) {
    const Node& node = tree.nodes()[index];
    return node.is_leaf()
               ? node.count
               : primitives_below(tree, node.first) + primitives_below(tree, node.first + 1);
}

TEST(BuildSweepSah, SplitsTheRootWhereItIsCheapest) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto boxes = triangle_boxes(test::triangle_soup(seed, 5 + 3 * seed).view());
        const Tree tree = Tree::build(boxes, {.builder = Builder::sweep_sah});
        double cost = 0.0;
        for (const std::uint32_t child : {1U, 2U}) {
            cost += static_cast<double>(primitives_below(tree, child)) *
                    tree.nodes()[child].box.half_area();
        }
        EXPECT_DOUBLE_EQ(cost, cheapest_cut(boxes)) << seed;
    }
}

}  // namespace
}  // namespace earshot::bvh
