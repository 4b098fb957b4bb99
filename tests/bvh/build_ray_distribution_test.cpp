// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/ray.h"

#include <gtest/gtest.h>

#include "bvh/tree_bits.h"
#include "support/meshes.h"
#include "support/tree_walker.h"
#include <algorithm>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Aabb;
using geometry::Segment;
using geometry::Vec3;

/// Short segments in one corner of the cube that the soups fill.
std::vector<Segment> rays_in_a_corner(std::uint64_t seed, std::size_t count) {
    std::vector<Segment> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 from = test::random_point(seed, 2 * i, 0.5, 0.8);
        rays.push_back({from, from + 0.2 * test::random_point(seed, 2 * i + 1)});
    }
    return rays;
}

std::size_t visits(const Tree& tree, const std::vector<Segment>& rays) {
    std::size_t count = 0;
    for (const Segment& ray : rays) {
        const geometry::SlabTest slab_test(ray.from, ray.to - ray.from, max_abs_coordinate(tree));
        traverse(
            tree,
            [&](const Node& node) {
                ++count;
                return !slab_test.interval(node.box, 1.0).is_empty();
            },
            [](std::uint32_t) { return true; });
    }
    return count;
}

TEST(RayBlendWeight, IsAsPublished) {
    EXPECT_DOUBLE_EQ(ray_blend_weight(0), 0.0);
    EXPECT_DOUBLE_EQ(ray_blend_weight(10), 0.45);
    EXPECT_DOUBLE_EQ(ray_blend_weight(90), 0.81);
}

TEST(BuildRayDistribution, MakesASoundTreeWithSmallLeaves) {
    const auto boxes = triangle_boxes(test::triangle_soup(1, 5000).view());
    const auto rays = rays_in_a_corner(1, 500);
    for (const int max_leaf_size : {1, 4, 15}) {
        const Tree tree = Tree::build(boxes, {.max_leaf_size = max_leaf_size, .rays = rays});
        EXPECT_EQ(test::fault_of(tree, boxes, static_cast<std::size_t>(max_leaf_size)), "");
    }
}

TEST(BuildRayDistribution, IsTheHeuristicOfAreasWhereNoRayComes) {
    const auto boxes = triangle_boxes(test::triangle_soup(2, 30000).view());
    const std::vector<Segment> elsewhere = {{Vec3(50.0), Vec3(51.0)}};
    EXPECT_TRUE(same_bits(Tree::build(boxes, {.rays = elsewhere}), Tree::build(boxes)));
}

TEST(BuildRayDistribution, DoesNotDependOnThreadsOrTheInstructionSet) {
    const auto boxes = triangle_boxes(test::triangle_soup(3, 10000).view());
    const auto rays = rays_in_a_corner(3, 300);
    const BuildOptions options{.rays = rays};
    EXPECT_FALSE(same_bits(Tree::build(boxes, options), Tree::build(boxes)));
    expect_the_same_tree_everywhere(boxes, options);
}

TEST(BuildRayDistribution, SavesVisitsForRaysLikeTheSample) {
    const auto mesh = test::triangle_soup(4, 20000);
    const auto boxes = triangle_boxes(mesh.view());
    const auto sample = rays_in_a_corner(4, 1000);
    const auto others = rays_in_a_corner(5, 1000);
    const Tree usual = Tree::build(boxes);
    const Tree tree = Tree::build(boxes, {.rays = sample});
    EXPECT_LT(static_cast<double>(visits(tree, others)),
              0.97 * static_cast<double>(visits(usual, others)));
    for (const Segment& ray : others) {
        const geometry::Ray traced{.origin = ray.from, .direction = ray.to - ray.from};
        ASSERT_EQ(closest_hit(tree, mesh.view(), traced), closest_hit(usual, mesh.view(), traced));
    }
}

TEST(BuildRayDistribution, TakesRaysThatArePointsAndBoxesThatAreHuge) {
    const std::vector<Segment> points = {{Vec3(0.0), Vec3(0.0)}, {Vec3(0.1), Vec3(0.1)}};
    const auto boxes = triangle_boxes(test::triangle_soup(6, 500).view());
    EXPECT_EQ(test::fault_of(Tree::build(boxes, {.rays = points}), boxes, 4), "");
    std::vector<Aabb> huge(100, Aabb{{-3e38F, -3e38F, -3e38F}, {3e38F, 3e38F, 3e38F}});
    EXPECT_EQ(test::fault_of(Tree::build(huge, {.rays = points}), huge, 4), "");
    const std::vector<Aabb> same(100, Aabb{{0, 0, 0}, {1, 1, 1}});
    EXPECT_EQ(test::fault_of(Tree::build(same, {.rays = points}), same, 4), "");
}

TEST(BuildRayDistribution, RefusesRaysThatAreNotFinite) {
    const std::vector<Aabb> one = {Aabb{{0, 0, 0}, {1, 1, 1}}};
    const std::vector<Segment> endless = {
        {Vec3(0.0), Vec3(std::numeric_limits<double>::infinity(), 0.0, 0.0)}};
    EXPECT_THROW(Tree::build(one, {.rays = endless}), Error);
}

}  // namespace
}  // namespace earshot::bvh
