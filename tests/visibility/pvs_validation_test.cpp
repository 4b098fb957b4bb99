// SPDX-License-Identifier: MIT
#include "earshot/visibility/pvs_validation.h"

#include "earshot/bvh/brute_force.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/guided_sampling.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include "support/meshes.h"
#include "visibility/screens.h"
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;
using test::add_screen;
using test::tree_of;

std::vector<ObjectId> all_of(const Mesh& mesh) {
    std::vector<ObjectId> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0U);
    return all;
}

MissedShare validate(const Mesh& mesh,
                     const ViewCells& cells,
                     const std::vector<std::vector<ObjectId>>& sets,
                     const ValidationOptions& options) {
    return validate_pvs({tree_of(mesh), mesh.view()},
                        Objects::triangles(mesh.triangles.size()),
                        cells,
                        sets,
                        options);
}

/// Five standard deviations of the estimate.
double tolerance(double share, const MissedShare& measured) {
    return 5.0 * std::sqrt(share * (1.0 - share) / static_cast<double>(measured.rays));
}

// The solid angle of a rectangle of half sides a and b at distance d before its middle.
double share_of_rectangle(double a, double b, double d) {
    return 4.0 * std::asin(a * b / std::sqrt((a * a + d * d) * (b * b + d * d))) /
           (4.0 * std::numbers::pi);
}

TEST(ValidatePvs, MeasuresTheSolidAngleOfAMissingFace) {
    const Mesh room = test::cube(1, 2.0);
    ASSERT_EQ(room.triangles.size(), 12U);
    const ViewCells eye({Vec3(0.0), Vec3(0.0)});
    for (std::size_t missing = 0; missing <= 12; missing += 2) {
        std::vector<ObjectId> set = all_of(room);
        set.resize(12 - missing);
        const MissedShare measured = validate(room, eye, {set}, {.rays = 120'000});
        const double expected = static_cast<double>(missing) / 12.0;
        EXPECT_EQ(measured.rays, 120'000U);
        EXPECT_NEAR(measured.estimate(), expected, tolerance(expected, measured));
        EXPECT_GT(measured.upper_bound(), measured.estimate() - (missing == 12 ? 1e-9 : 0.0));
    }
}

TEST(ValidatePvs, MeasuresTheSolidAngleOfARectangleFromAnyDistance) {
    for (const double distance : {0.5, 3.0, 20.0}) {
        Mesh mesh;
        add_screen(mesh, {-1.0, -0.75, -distance}, {1.0, 0.75, -distance}, 4, 4);
        const ViewCells eye({Vec3(0.0), Vec3(0.0)});
        const MissedShare measured = validate(mesh, eye, {{}}, {.rays = 200'000});
        const double expected = share_of_rectangle(1.0, 0.75, distance);
        EXPECT_NEAR(measured.estimate(), expected, tolerance(expected, measured)) << distance;
        EXPECT_EQ(validate(mesh, eye, {all_of(mesh)}, {.rays = 200'000}).missed, 0U);
    }
}

// Every cell counts with its own set, in proportion to its volume.
TEST(ValidatePvs, LooksUpTheCellOfEveryViewpoint) {
    const Mesh room = test::cube(2, 4.0);
    const ViewCells cells = ViewCells::grid({{-1.0, -1.0, -1.0}, {3.0, 1.0, 1.0}}, {4, 1, 1});
    const std::vector<ObjectId> all = all_of(room);
    const MissedShare measured = validate(room, cells, {all, {}, all, all}, {.rays = 100'000});
    EXPECT_NEAR(measured.estimate(), 0.25, tolerance(0.25, measured));
}

TEST(ValidatePvs, AgreesWithOtherRaysAgainstAllTriangles) {
    const Mesh mesh = test::triangle_soup(3, 400);
    const ViewRegion region = {Vec3(-0.4), Vec3(0.4)};
    const ViewCells cells(region);
    const RegionPvs pvs = sample_region({tree_of(mesh), mesh.view()}, region, {.max_rays = 300});
    const MissedShare measured = validate(mesh, cells, {pvs.triangles}, {.rays = 50'000});
    support::Dice dice(11);
    std::size_t missed = 0;
    constexpr std::size_t kRays = 20'000;
    for (std::size_t i = 0; i < kRays; ++i) {
        geometry::Ray ray;
        do {  // uniform in the ball: a direction uniform on the sphere
            for (int k = 0; k < 3; ++k) {
                ray.origin[k] = dice.between(-0.4, 0.4);
                ray.direction[k] = dice.between(-1.0, 1.0);
            }
        } while (glm::dot(ray.direction, ray.direction) > 1.0);
        const auto hit = bvh::brute_force::closest_hit(mesh.view(), ray);
        missed +=
            hit && !std::binary_search(pvs.triangles.begin(), pvs.triangles.end(), hit->triangle)
                ? 1
                : 0;
    }
    const double other = static_cast<double>(missed) / kRays;
    EXPECT_GT(missed, 100U);
    EXPECT_NEAR(measured.estimate(),
                other,
                5.0 * std::sqrt(other * (1.0 - other) * (1.0 / kRays + 1.0 / 50'000)));
}

// The bound holds in at least 95 % of all batches; here the truth has a closed form.
TEST(ValidatePvs, BoundsTheTruthAsOftenAsItSays) {
    Mesh mesh;
    add_screen(mesh, {-1.0, -1.0, -8.0}, {1.0, 1.0, -8.0}, 1);
    const double truth = share_of_rectangle(1.0, 1.0, 8.0);
    const auto tree = tree_of(mesh);
    int covered = 0;
    int silent = 0;  // batches without a missed ray
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const MissedShare measured = validate_pvs({tree, mesh.view()},
                                                  Objects::triangles(2),
                                                  ViewCells({Vec3(0.0), Vec3(0.0)}),
                                                  std::vector<std::vector<ObjectId>>{{}},
                                                  {.seed = seed, .rays = 400});
        covered += measured.upper_bound() >= truth ? 1 : 0;
        silent += measured.missed == 0 ? 1 : 0;
    }
    // Three standard deviations below 380 of 400.
    EXPECT_GE(covered, 366);
    EXPECT_GT(silent, 10);
}

// Short runs that once reported 0 because their last batch was too short to find anything.
TEST(ValidatePvs, ReportsWhatShortRunsMiss) {
    const Mesh mesh = test::sphere(4, 1.0, {0.0, 0.0, -6.0});
    const ViewRegion region = {Vec3(-0.5), Vec3(0.5)};
    const auto tree = tree_of(mesh);
    for (const std::uint64_t rays : {200U, 1000U, 4000U}) {
        const RegionPvs pvs = sample_region({tree, mesh.view()}, region, {.max_rays = rays});
        const RegionPvs longer = sample_region({tree, mesh.view()}, region, {.max_rays = 300'000});
        ASSERT_LT(pvs.triangles.size(), longer.triangles.size());
        const MissedShare measured =
            validate(mesh, ViewCells(region), {pvs.triangles}, {.rays = 100'000});
        EXPECT_GT(measured.missed, 0U) << rays;
    }
}

TEST(ValidatePvs, IsTheSameForAnyExecutorAndTree) {
    const Mesh mesh = test::triangle_soup(5, 700);
    const ViewCells cells = ViewCells::grid({Vec3(-0.5), Vec3(0.5)}, {2, 2, 1});
    const Objects objects = Objects::groups(mesh.view(), 8);
    const auto sets =
        sample_cells({tree_of(mesh), mesh.view()}, objects, cells, {.max_rays = 4000}).visible;
    const ValidationOptions options = {.seed = 4, .rays = 70'000};
    const MissedShare once =
        validate_pvs({tree_of(mesh), mesh.view()}, objects, cells, sets, options);
    EXPECT_GT(once.missed, 0U);
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        EXPECT_EQ(validate_pvs({tree_of(mesh, bvh::Builder::lbvh), mesh.view()},
                               objects,
                               cells,
                               sets,
                               options,
                               executor),
                  once);
    }
}

TEST(ValidatePvs, KnowsNothingWithoutRays) {
    const Mesh room = test::cube(1, 2.0);
    const MissedShare none = validate(room, ViewCells({Vec3(0.0), Vec3(0.0)}), {{}}, {.rays = 0});
    EXPECT_EQ(none, MissedShare{});
    EXPECT_EQ(none.upper_bound(), 1.0);
}

}  // namespace
}  // namespace earshot::visibility
