// SPDX-License-Identifier: MIT
#include "earshot/bvh/overlap.h"

#include "earshot/bvh/brute_force.h"

#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <cmath>

namespace earshot::bvh {
namespace {

using geometry::BoxRegion;
using geometry::ConvexRegion;
using geometry::Plane;
using geometry::SphereRegion;
using geometry::TriangleRegion;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 41;

/// A corner of space with a lid, turned at random.
ConvexRegion random_frustum(const Vec3& at, double size, std::uint64_t i) {
    std::vector<Plane> planes;
    for (std::uint64_t k = 0; k < 4; ++k) {
        const Vec3 normal = test::random_point(kSeed, 10 * i + k);
        planes.push_back({normal, glm::dot(normal, at)});
    }
    const Vec3 normal = glm::normalize(test::random_point(kSeed, 10 * i + 5));
    planes.push_back({normal, glm::dot(normal, at) + 0.3 * size});
    return ConvexRegion(planes);
}

template <class Make>
void expect_brute_force(const char* kind, const Make& make) {
    std::size_t found = 0;
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const auto trees = test::query_trees(of.mesh);
        for (std::uint64_t i = 0; i < 160; ++i) {
            const auto region = make(of, i);
            const auto expected = brute_force::overlapping(of.mesh.view(), region);
            found += expected.size();
            for (const Tree& tree : trees) {
                ASSERT_EQ(overlapping(tree, of.mesh.view(), region), expected)
                    << kind << ", " << of.name << ", seed " << kSeed << ", region " << i;
            }
        }
    }
    EXPECT_GT(found, 1000U) << kind;
}

TEST(Overlap, EqualsBruteForceForEveryTree) {
    expect_brute_force("box", [](const test::QueryMesh& of, std::uint64_t i) {
        const Vec3 lower = test::query_point(of, kSeed, i);
        return BoxRegion(lower, lower + of.size * test::random_point(kSeed, i, 0.0, 0.4));
    });
    expect_brute_force("flat box", [](const test::QueryMesh& of, std::uint64_t i) {
        const Vec3 lower = test::query_point(of, kSeed, i);
        Vec3 size = of.size * test::random_point(kSeed, i, 0.0, 0.4);
        size[static_cast<int>(i % 3)] = 0.0;
        return BoxRegion(lower, lower + size);
    });
    expect_brute_force("sphere", [](const test::QueryMesh& of, std::uint64_t i) {
        return SphereRegion(test::query_point(of, kSeed, i), 0.3 * of.size * random(kSeed, 9, i));
    });
    expect_brute_force("frustum", [](const test::QueryMesh& of, std::uint64_t i) {
        return random_frustum(test::query_point(of, kSeed, i), of.size, i);
    });
    expect_brute_force("triangle", [](const test::QueryMesh& of, std::uint64_t i) {
        const Vec3 a = test::query_point(of, kSeed, i);
        const Vec3 b = a + of.size * test::random_point(kSeed, i);
        return TriangleRegion(a, b, i % 5 == 0 ? b : test::query_point(of, kSeed, i + 1));
    });
}

TEST(Overlap, ATriangleOfAMeshTouchesItsNeighbours) {
    const auto mesh = test::cube(4, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& corners = mesh.triangles[i];
        std::vector<geometry::TriangleId> neighbours;
        for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
            const auto& other = mesh.triangles[k];
            if (std::find_first_of(corners.begin(), corners.end(), other.begin(), other.end()) !=
                corners.end()) {
                neighbours.push_back(static_cast<geometry::TriangleId>(k));
            }
        }
        const TriangleRegion region(
            mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]);
        EXPECT_EQ(overlapping(tree, mesh.view(), region), neighbours) << i;
    }
}

TEST(Overlap, EndsWhereTheCallerStops) {
    const auto mesh = test::sphere(3, 1.0, Vec3(0.0));
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    std::size_t visits = 0;
    visit_overlapping(tree, mesh.view(), SphereRegion(Vec3(0.0), 2.0), [&](geometry::TriangleId) {
        return ++visits < 5;
    });
    EXPECT_EQ(visits, 5U);
}

TEST(Overlap, InvalidRegionsTouchNothing) {
    const auto mesh = test::cube(2, 0.5);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const double nan = std::nan("");
    const std::vector<Plane> unknown = {{{nan, 0, 0}, 0.0}};
    EXPECT_EQ(overlapping(tree, mesh.view(), BoxRegion(Vec3(-1), Vec3(1))).size(), 48U);
    EXPECT_TRUE(overlapping(tree, mesh.view(), BoxRegion(Vec3(1), Vec3(-1))).empty());
    EXPECT_TRUE(overlapping(tree, mesh.view(), BoxRegion(Vec3(nan), Vec3(1))).empty());
    EXPECT_TRUE(overlapping(tree, mesh.view(), SphereRegion(Vec3(nan), 1)).empty());
    EXPECT_TRUE(overlapping(tree, mesh.view(), SphereRegion(Vec3(0), nan)).empty());
    EXPECT_TRUE(overlapping(tree, mesh.view(), ConvexRegion(unknown)).empty());
    EXPECT_TRUE(
        overlapping(tree, mesh.view(), TriangleRegion(Vec3(nan), Vec3(0), Vec3(1))).empty());
}

}  // namespace
}  // namespace earshot::bvh
