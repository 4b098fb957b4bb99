// SPDX-License-Identifier: MIT
#include "earshot/visibility/guided_sampling.h"

#include "earshot/base/error.h"
#include "earshot/bvh/brute_force.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include "visibility/screens.h"
#include <algorithm>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;
using test::add_screen;
using test::tree_of;

bool has(const RegionPvs& view, TriangleId triangle) {
    return std::binary_search(view.triangles.begin(), view.triangles.end(), triangle);
}

TEST(GuidedSampling, FindsAllOfAConvexRoom) {
    const Mesh room = test::cube(12, 3.0);
    const ViewRegion region = {Vec3(-0.5), Vec3(0.5)};
    const RegionPvs view =
        sample_region({tree_of(room), room.view()}, region, {.max_rays = 100'000});
    EXPECT_EQ(view.triangles.size(), room.triangles.size());
}

// Seen through a slit the tiles of a wall that lie wholly within two tangents are found, and none
// that lie wholly beyond them.
TEST(GuidedSampling, FindsThroughASlitTheTrianglesOfItsTangents) {
    Mesh mesh;
    constexpr double kSlit = 0.02;
    add_screen(mesh, {-50.0, -50.0, -2.0}, {-0.5 * kSlit, 50.0, -2.0}, 1);
    add_screen(mesh, {0.5 * kSlit, -50.0, -2.0}, {50.0, 50.0, -2.0}, 1);
    const auto tiles = add_screen(mesh, {-8.0, -0.5, -6.0}, {8.0, 0.5, -6.0}, 400, 4);
    const ViewRegion region = {{-1.0, -0.5, -0.5}, {1.0, 0.5, 0.0}};
    const RegionPvs view =
        sample_region({tree_of(mesh), mesh.view()}, region, {.max_rays = 200'000});
    // From the region's corner at (1, z = -0.5) past the slit's far border, where the slope is the
    // steepest: x = -0.01 - (1.01 / 1.5) * 4.
    const double border = 0.5 * kSlit + (1.0 + 0.5 * kSlit) / 1.5 * 4.0;
    std::size_t within = 0;
    for (const test::Tile& tile : tiles) {
        if (tile.left > -border && tile.right < border) {
            ++within;
            ASSERT_TRUE(has(view, tile.triangles[0]) && has(view, tile.triangles[1]))
                << "tile at " << tile.left;
        } else if (tile.right < -border || tile.left > border) {
            ASSERT_FALSE(has(view, tile.triangles[0]) || has(view, tile.triangles[1]))
                << "tile at " << tile.left;
        }
    }
    EXPECT_GT(within, 500U);
    EXPECT_LT(within, tiles.size() - 500);
}

TEST(GuidedSampling, FloodsAMeshFromOneRay) {
    Mesh mesh;
    add_screen(mesh, {-1.0, -1.0, -4.0}, {1.0, 1.0, -4.0}, 64, 64);
    const ViewRegion eye = {Vec3(0.0), Vec3(0.0)};
    const RegionPvs view = sample_region({tree_of(mesh), mesh.view()}, eye, {.max_rays = 250'000});
    EXPECT_GE(view.triangles.size(), 8184U);  // 99.9 % of 8,192
}

TEST(GuidedSampling, WitnessesProveEveryTriangle) {
    const Mesh mesh = test::triangle_soup(7, 800);
    const ViewRegion region = {Vec3(-0.2), Vec3(0.1, 0.2, 0.3)};
    const RegionPvs view =
        sample_region({tree_of(mesh), mesh.view()}, region, {.max_rays = 60'000});
    ASSERT_EQ(view.witnesses.size(), view.triangles.size());
    std::size_t proved = 0;
    for (std::size_t i = 0; i < view.triangles.size(); ++i) {
        const geometry::Ray& ray = view.witnesses[i];
        // Origins are computed on the region's border, to a rounding.
        const ViewRegion wider = {region.lower - Vec3(1e-12), region.upper + Vec3(1e-12)};
        ASSERT_TRUE(wider.contains(ray.origin));
        if (ray.t_max > 0.0) {
            const auto hit = bvh::brute_force::closest_hit(mesh.view(), ray);
            ASSERT_TRUE(hit && hit->triangle == view.triangles[i]);
            ++proved;
        }
    }
    EXPECT_GT(proved, 100U);
}

TEST(GuidedSampling, TrianglesThatReachIntoTheRegionAreVisible) {
    Mesh mesh;
    // A speck inside of the region that no ray from its border outward meets.
    mesh.positions = {{0.0, 0.0, 0.0}, {0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}};
    mesh.triangles = {{0, 1, 2}};
    const RegionPvs view =
        sample_region({tree_of(mesh), mesh.view()}, {Vec3(-1.0), Vec3(1.0)}, {.max_rays = 1000});
    EXPECT_EQ(view.triangles, (std::vector<TriangleId>{0}));
    EXPECT_EQ(view.witnesses[0].t_max, 0.0);
}

TEST(GuidedSampling, NeedsFewerRaysThanRandomSampling) {
    const Mesh mesh = test::sphere(5, 1.0, {0.0, 0.0, -5.0});
    const ViewRegion region = {Vec3(-0.1), Vec3(0.1)};
    const auto tree = tree_of(mesh);
    const RegionPvs guided = sample_region({tree, mesh.view()}, region, {.max_rays = 100'000});
    const RegionPvs random =
        sample_region({tree, mesh.view()}, region, {.max_rays = 2'000'000, .guided = false});
    EXPECT_GE(guided.triangles.size(), random.triangles.size());
}

TEST(GuidedSampling, DependsOnTheSeedButNotOnExecutorOrTree) {
    const Mesh mesh = test::triangle_soup(9, 2000);
    const ViewRegion region = {Vec3(-0.3), Vec3(0.3)};
    const GuidedSamplingOptions options = {.max_rays = 50'000};
    const RegionPvs once = sample_region({tree_of(mesh), mesh.view()}, region, options);
    for (const int threads : {1, 2, 8}) {
        for (const bvh::Builder builder : {bvh::Builder::binned_sah, bvh::Builder::lbvh}) {
            Executor executor(threads);
            const RegionPvs again =
                sample_region({tree_of(mesh, builder), mesh.view()}, region, options, executor);
            EXPECT_EQ(again.triangles, once.triangles);
            EXPECT_EQ(again.rays, once.rays);
            ASSERT_EQ(again.curve.size(), once.curve.size());
            EXPECT_EQ(again.curve.back().triangles, once.curve.back().triangles);
        }
    }
    EXPECT_LE(once.rays, 50'000U);
}

TEST(GuidedSampling, EndsWhenLittleIsNew) {
    const Mesh room = test::cube(2, 3.0);
    const RegionPvs view = sample_region({tree_of(room), room.view()},
                                         {Vec3(-0.5), Vec3(0.5)},
                                         {.window = 20'000, .min_new_triangles = 1});
    EXPECT_LT(view.rays, 100'000U);
    EXPECT_EQ(view.triangles.size(), room.triangles.size());
}

TEST(GuidedSampling, HandlesEmptyMeshesAndRefusesInvalidRegions) {
    EXPECT_TRUE(sample_region({bvh::WideTree(), {}}, {Vec3(0.0), Vec3(1.0)}).triangles.empty());
    EXPECT_THROW(sample_region({bvh::WideTree(), {}}, {Vec3(0.0), Vec3(1.0, -1.0, 1.0)}), Error);
    EXPECT_THROW(sample_region({bvh::WideTree(), {}}, {Vec3(0.0), Vec3(1.0, NAN, 1.0)}), Error);
    EXPECT_THROW(sample_region({bvh::WideTree(), {}}, {Vec3(0.0), Vec3(1.0, INFINITY, 1.0)}),
                 Error);
}

}  // namespace
}  // namespace earshot::visibility
