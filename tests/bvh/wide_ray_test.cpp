// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_ray.h"

#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/ray.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <array>
#include <cmath>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

WideTree wide_tree_of(const Mesh& mesh, int max_leaf_size = 4) {
    return WideTree::build(
        Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = max_leaf_size}), mesh.view());
}

/// Rays through the mesh, at its corners and edges, in the planes of triangles, along axes, from
/// its surface, and of limited length.
Ray aimed_ray(const Mesh& mesh, std::uint64_t seed, std::uint64_t i) {
    const auto& triangle = mesh.triangles[random_bits(seed, 5, i) % mesh.triangles.size()];
    const Vec3& a = mesh.positions[triangle[0]];
    const Vec3& b = mesh.positions[triangle[1]];
    const Vec3& c = mesh.positions[triangle[2]];
    const double size = glm::distance(a, b) + glm::distance(a, c);
    Ray ray{.origin = a + 5.0 * size * test::random_point(seed, i)};
    const std::array<Vec3, 5> targets = {
        a, 0.5 * (a + b), (a + b + c) / 3.0, 0.3 * a + 0.7 * c, a + size * (c - b)};
    ray.direction = targets[i % 5] - ray.origin;
    if (i % 7 == 0) {
        ray.origin = a;
        ray.direction = b - a;
    } else if (i % 7 == 1) {
        const int axis = static_cast<int>(i / 7 % 3);
        ray.direction = Vec3(0.0);
        ray.direction[axis] = i % 2 == 0 ? 1.0 : -1.0;
        ray.origin[(axis + 1) % 3] = a[(axis + 1) % 3];
        ray.origin[(axis + 2) % 3] = a[(axis + 2) % 3];
    } else if (i % 7 == 2) {
        ray.origin = (a + b + c) / 3.0;
    }
    if (i % 11 == 0) {
        ray.t_max = i % 2 == 0 ? 1.0 : 2.0 * random(seed, 7, i);
    }
    return ray;
}

void expect_equal_answers(const Mesh& mesh, const WideTree& wide, std::uint64_t seed) {
    for (std::uint64_t i = 0; i < 600; ++i) {
        const Ray ray = aimed_ray(mesh, seed, i);
        ASSERT_EQ(closest_hit(wide, mesh.view(), ray), brute_force::closest_hit(mesh.view(), ray))
            << "seed " << seed << ", ray " << i;
        const Segment segment = {ray.origin, ray.origin + ray.direction};
        ASSERT_EQ(occluded(wide, mesh.view(), segment), brute_force::occluded(mesh.view(), segment))
            << "seed " << seed << ", segment " << i;
    }
}

Mesh moved(Mesh mesh, double scale, const Vec3& offset) {
    for (Vec3& position : mesh.positions) {
        position = scale * position + offset;
    }
    return mesh;
}

TEST(WideRay, EqualsBruteForceWithEverySimdTarget) {
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        for (const std::uint64_t seed : {1U, 2U, 3U}) {
            const Mesh mesh = test::triangle_soup(seed, 400);
            expect_equal_answers(mesh, wide_tree_of(mesh), seed);
        }
    }
    override_simd_target("auto");
}

TEST(WideRay, EqualsBruteForceAtAnyScaleAndPlace) {
    const Mesh mesh = test::triangle_soup(4, 300);
    for (const double scale : {1e-30, 1e-12, 1e-4, 1e4, 1e12, 1e30}) {
        const Mesh scaled = moved(mesh, scale, Vec3(0.0));
        expect_equal_answers(scaled, wide_tree_of(scaled), 4);
    }
    for (const double distance : {10.0, 1e4, 1e9}) {
        const Mesh far = moved(mesh, 0.1, Vec3(distance, -distance, 0.5 * distance));
        expect_equal_answers(far, wide_tree_of(far), 5);
    }
}

TEST(WideRay, EqualsBruteForceForDegenerateTriangles) {
    Mesh mesh = test::triangle_soup(6, 200);
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
        auto& triangle = mesh.triangles[i];
        Vec3& c = mesh.positions[triangle[2]];
        const Vec3& a = mesh.positions[triangle[0]];
        const Vec3& b = mesh.positions[triangle[1]];
        c = i % 2 == 0 ? a + 0.25 * (b - a) + 1e-12 * c : 0.5 * (a + b) + 1e-7 * c;
    }
    const WideTree wide = wide_tree_of(mesh);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Ray ray = aimed_ray(mesh, 6, i);
        ASSERT_EQ(closest_hit(wide, mesh.view(), ray), brute_force::closest_hit(mesh.view(), ray))
            << i;
    }
}

TEST(WideRay, BreaksTiesByTheLowestTriangle) {
    Mesh mesh = test::triangle_soup(7, 40);
    const auto once = mesh.triangles;
    for (int copy = 0; copy < 6; ++copy) {
        mesh.triangles.insert(mesh.triangles.begin(), once.rbegin(), once.rend());
    }
    expect_equal_answers(mesh, wide_tree_of(mesh), 7);
    expect_equal_answers(mesh, wide_tree_of(mesh, 15), 8);
}

TEST(WideRay, AnswersInvalidRays) {
    const Mesh mesh = test::triangle_soup(8, 100);
    const WideTree wide = wide_tree_of(mesh);
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const double odd : {0.0, -0.0, 5e-324, 1e-310, 1e300, kInfinity, -kInfinity, none}) {
        for (int axis = 0; axis < 3; ++axis) {
            Ray ray = aimed_ray(mesh, 8, static_cast<std::uint64_t>(axis));
            ray.direction[axis] = odd;
            EXPECT_EQ(closest_hit(wide, mesh.view(), ray),
                      brute_force::closest_hit(mesh.view(), ray));
            ray = aimed_ray(mesh, 9, static_cast<std::uint64_t>(axis));
            ray.origin[axis] = odd;
            EXPECT_EQ(closest_hit(wide, mesh.view(), ray),
                      brute_force::closest_hit(mesh.view(), ray));
        }
        Ray ray = aimed_ray(mesh, 10, 2);
        ray.t_max = odd;
        EXPECT_EQ(closest_hit(wide, mesh.view(), ray), brute_force::closest_hit(mesh.view(), ray));
    }
}

TEST(WideRay, FindsNothingInAnEmptyScene) {
    const Mesh mesh;
    const WideTree wide = wide_tree_of(mesh);
    EXPECT_FALSE(closest_hit(wide, mesh.view(), {}));
    EXPECT_FALSE(occluded(wide, mesh.view(), {Vec3(0.0), Vec3(1.0)}));
    EXPECT_EQ(wide.max_abs_coordinate(), 0.0);
}

TEST(WideRay, KeepsItsAnswersWhenRefitted) {
    Mesh mesh = test::triangle_soup(11, 500);
    WideTree wide = wide_tree_of(mesh);
    for (int frame = 0; frame < 4; ++frame) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            mesh.positions[i] +=
                0.3 * test::random_point(20 + static_cast<std::uint64_t>(frame), i);
        }
        wide.refit(mesh.view());
        expect_equal_answers(mesh, wide, 12);
    }
}

}  // namespace
}  // namespace earshot::bvh
