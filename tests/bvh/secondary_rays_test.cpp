// SPDX-License-Identifier: MIT
// Rays and segments that start on surfaces, against brute force.
#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/wide_batch.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

struct Reflections {
    std::vector<Ray> rays;
    std::vector<Segment> segments;
    std::vector<geometry::TriangleId> origin_triangles;
};

/// From random points of random triangles to random sides, a little off the surface.
Reflections reflections(const Mesh& mesh, std::uint64_t seed, std::size_t count) {
    Reflections made;
    for (std::size_t i = 0; i < count; ++i) {
        const auto id =
            static_cast<geometry::TriangleId>(random_bits(seed, 7, i) % mesh.triangles.size());
        const auto& [a, b, c] = mesh.triangles[id];
        const Vec3& p = mesh.positions[a];
        const Vec3 ab = mesh.positions[b] - p;
        const Vec3 ac = mesh.positions[c] - p;
        const double u = random(seed, 8, i);
        const double v = random(seed, 9, i) * (1.0 - u);
        const double size = glm::length(ab) + glm::length(ac);
        Vec3 normal = glm::normalize(glm::cross(ab, ac));
        Vec3 direction = size * test::random_point(seed, 1000 + i);
        if (i % 7 == 0) {
            direction -= 0.999 * glm::dot(direction, normal) * normal;  // grazing
        }
        normal *= std::copysign(1.0, glm::dot(normal, direction));
        const Vec3 from = p + u * ab + v * ac + 0x1p-32 * size * normal;
        made.rays.push_back({from, direction});
        made.segments.push_back({from, from + random_between(seed, 10, i, 0.1, 10.0) * direction});
        made.origin_triangles.push_back(id);
    }
    return made;
}

void expect_equal_answers(const Mesh& mesh, std::uint64_t seed, std::size_t count = 400) {
    const WideTree wide = WideTree::build(Tree::build(triangle_boxes(mesh.view())), mesh.view());
    const Reflections made = reflections(mesh, seed, count);
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        std::vector<std::optional<geometry::Hit>> hits(count);
        std::vector<std::uint8_t> blocked(count);
        closest_hits(wide,
                     mesh.view(),
                     SecondaryRays{.rays = made.rays, .origin_triangles = made.origin_triangles},
                     hits);
        occluded(
            wide,
            mesh.view(),
            SecondarySegments{.segments = made.segments, .origin_triangles = made.origin_triangles},
            blocked);
        std::size_t found = 0;
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(hits[i], brute_force::closest_hit(mesh.view(), made.rays[i]))
                << target << ", seed " << seed << ", ray " << i;
            ASSERT_EQ(blocked[i] == 1, brute_force::occluded(mesh.view(), made.segments[i]))
                << target << ", seed " << seed << ", segment " << i;
            found += hits[i] ? 1 : 0;
        }
        EXPECT_GT(found, count / 20);
    }
    override_simd_target("auto");
}

Mesh turned(Mesh mesh) {
    for (Vec3& p : mesh.positions) {
        p = {0.8 * p.x - 0.6 * p.z, p.y + 0.3, 0.6 * p.x + 0.8 * p.z};
    }
    return mesh;
}

TEST(SecondaryRays, OfSmallMeshesAreDecidedAsOneByOne) {
    expect_equal_answers(test::cube(1, 4.0), 1);
    expect_equal_answers(test::cube(1, 2.7), 2);
    expect_equal_answers(turned(test::cube(1, 4.0)), 3);
    expect_equal_answers(test::triangle_soup(4, 16), 4);
    expect_equal_answers(test::sphere(0, 2.0, Vec3(1.0)), 5);
}

TEST(SecondaryRays, AreDecidedAsOneByOneInTreesThatFitIntoTheCache) {
    expect_equal_answers(test::cube(6, 4.0), 6);
    expect_equal_answers(test::cube(6, 2.7), 7);
    expect_equal_answers(turned(test::cube(6, 4.0)), 8);
    expect_equal_answers(test::triangle_soup(9, 300), 9);
}

// Planes that coincide in single precision and not in double: a ray that starts on one hits the
// other.
TEST(SecondaryRays, HitAPlaneThatIsNearlyTheirOwn) {
    Mesh mesh = test::cube(4, 4.0);
    const auto count = static_cast<geometry::VertexId>(mesh.positions.size());
    const auto once = mesh.triangles;
    for (std::size_t i = 0; i < count; ++i) {
        mesh.positions.push_back((1.0 - 0x1p-30) * mesh.positions[i]);
    }
    for (const auto& [a, b, c] : once) {
        mesh.triangles.push_back({a + count, b + count, c + count});
    }
    expect_equal_answers(mesh, 10);
}

TEST(SecondaryRays, AreDecidedAsOneByOneInLargerTrees) {
    expect_equal_answers(test::triangle_soup(11, 26000), 11, 100);
    expect_equal_answers(test::cube(68, 4.0), 12, 100);
}

TEST(SecondaryRays, FindNothingInAnEmptyScene) {
    const Mesh mesh;
    const WideTree wide;
    std::vector<std::optional<geometry::Hit>> hits(1, geometry::Hit{});
    std::vector<std::uint8_t> blocked(1, 1);
    const std::vector<Ray> rays(1);
    const std::vector<Segment> segments(1);
    const std::vector<geometry::TriangleId> origin_triangles(1, 0);
    closest_hits(
        wide, mesh.view(), SecondaryRays{.rays = rays, .origin_triangles = origin_triangles}, hits);
    occluded(wide,
             mesh.view(),
             SecondarySegments{.segments = segments, .origin_triangles = origin_triangles},
             blocked);
    EXPECT_FALSE(hits[0]);
    EXPECT_EQ(blocked[0], 0);
}

}  // namespace
}  // namespace earshot::bvh
