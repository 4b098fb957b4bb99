// SPDX-License-Identifier: MIT
#include "earshot/bvh/mesh_bvh.h"

#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/deformable_bvh.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 53;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A hierarchy over a mesh, and one that was refitted to it from elsewhere.
std::vector<DeformableBvh> hierarchies(const Mesh& mesh) {
    auto moved = mesh;
    for (Vec3& position : moved.positions) {
        position = {position.z, -position.x, 0.5 * position.y};
    }
    std::vector<DeformableBvh> made;
    made.emplace_back(mesh.view());
    made.emplace_back(moved.view(),
                      UpdateOptions{.build = {.max_leaf_size = 15}, .queries_per_update = 0.0});
    made.back().update(mesh.view());
    return made;
}

Segment query_segment(const test::QueryMesh& of, std::uint64_t i) {
    const Ray ray = test::query_ray(of, kSeed, i);
    return {ray.origin, ray.origin + ray.direction};
}

template <class Check>
void for_each_query(std::uint64_t count, const Check& check) {
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        for (const DeformableBvh& hierarchy : hierarchies(of.mesh)) {
            for (std::uint64_t i = 0; i < count; ++i) {
                SCOPED_TRACE(std::string(of.name) + ", query " + std::to_string(i));
                check(of, hierarchy.view(), i);
                if (testing::Test::HasFatalFailure()) {
                    return;
                }
            }
        }
    }
}

TEST(MeshBvh, RaysHitWhatBruteForceFinds) {
    for_each_query(200, [](const test::QueryMesh& of, const MeshBvh& bvh, std::uint64_t i) {
        const Ray ray = test::query_ray(of, kSeed, i);
        const auto expected = brute_force::closest_hit(of.mesh.view(), ray);
        ASSERT_EQ(bvh.closest_hit(ray), expected);
        ASSERT_EQ(bvh.closest_hits(std::vector{ray}).front(), expected);
        const Segment segment = query_segment(of, i);
        const bool is_blocked = brute_force::occluded(of.mesh.view(), segment);
        ASSERT_EQ(bvh.occluded(segment), is_blocked);
        ASSERT_EQ(bvh.occluded(std::vector{segment}).front() != 0, is_blocked);
    });
}

TEST(MeshBvh, AnyHitOffersEveryTriangleThatASegmentTouches) {
    std::size_t touched = 0;
    for_each_query(200, [&](const test::QueryMesh& of, const MeshBvh& bvh, std::uint64_t i) {
        const Segment segment = query_segment(of, i);
        std::set<TriangleId> expected, offered;
        for (TriangleId id = 0; id < of.mesh.triangles.size(); ++id) {
            const auto [a, b, c] = geometry::corners(of.mesh, id);
            if (geometry::touches(segment, a, b, c)) {
                expected.insert(id);
            }
        }
        ASSERT_FALSE(bvh.any_hit(segment, [&](TriangleId id, double t) {
            const auto [a, b, c] = geometry::corners(of.mesh, id);
            EXPECT_EQ(geometry::first_touch(segment, a, b, c), t);
            EXPECT_TRUE(offered.insert(id).second);
            return false;
        }));
        ASSERT_EQ(offered, expected);
        std::size_t offers = 0;
        ASSERT_EQ(bvh.any_hit(segment, [&](TriangleId, double) { return ++offers > 0; }),
                  !expected.empty());
        ASSERT_LE(offers, 1U);
        touched += expected.size();
    });
    EXPECT_GT(touched, 1000U);
}

TEST(MeshBvh, ClosestPointEqualsBruteForce) {
    for_each_query(300, [](const test::QueryMesh& of, const MeshBvh& bvh, std::uint64_t i) {
        const Vec3 point = test::query_point(of, kSeed, i);
        const double max_distance = i % 3 == 0 ? 0.1 * of.size * random(kSeed, 9, i) : kInfinity;
        ASSERT_EQ(bvh.closest_point(point, max_distance),
                  brute_force::closest_point(of.mesh.view(), point, max_distance));
    });
}

TEST(MeshBvh, ClosestPointOfInvalidQueriesIsNone) {
    const Mesh mesh = test::cube(2, 0.5);
    const DeformableBvh hierarchy(mesh.view());
    const MeshBvh bvh = hierarchy.view();
    EXPECT_TRUE(bvh.closest_point({1, 0, 0}, 0.5));
    EXPECT_FALSE(bvh.closest_point({1, 0, 0}, std::nextafter(0.5, 0.0)));
    EXPECT_FALSE(bvh.closest_point({1, 0, 0}, std::nan("")));
    EXPECT_FALSE(bvh.closest_point({1, 0, 0}, -1.0));
    EXPECT_FALSE(bvh.closest_point({std::nan(""), 0, 0}));
    EXPECT_FALSE(bvh.closest_point({0, kInfinity, 0}));
    EXPECT_FALSE(DeformableBvh(geometry::MeshView{}).view().closest_point({1, 0, 0}));
}

TEST(MeshBvh, OverlappingEqualsBruteForce) {
    for_each_query(100, [](const test::QueryMesh& of, const MeshBvh& bvh, std::uint64_t i) {
        const Vec3 at = test::query_point(of, kSeed, i);
        const double radius = 0.5 * of.size * random(kSeed, 10, i);
        const geometry::SphereRegion sphere(at, radius);
        ASSERT_EQ(bvh.overlapping(sphere), brute_force::overlapping(of.mesh.view(), sphere));
        const geometry::BoxRegion box(at - 0.5 * radius, at + radius);
        ASSERT_EQ(bvh.overlapping(box), brute_force::overlapping(of.mesh.view(), box));
    });
}

}  // namespace
}  // namespace earshot::bvh
