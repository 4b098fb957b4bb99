// SPDX-License-Identifier: MIT
#include "earshot/bvh/ray.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "support/bunny.h"
#include "support/meshes.h"
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Vec3;
using geometry::VertexId;

/// The mesh as it is, 25 cm across, and 10 km away.
std::vector<Mesh> in_three_places(const Mesh& mesh) {
    Vec3 lower = mesh.positions[0];
    Vec3 upper = lower;
    for (const Vec3& position : mesh.positions) {
        lower = glm::min(lower, position);
        upper = glm::max(upper, position);
    }
    const Vec3 extent = upper - lower;
    const double scale = 0.25 / std::max({extent.x, extent.y, extent.z});
    std::vector<Mesh> result(3, mesh);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        result[1].positions[i] = scale * (mesh.positions[i] - lower);
        result[2].positions[i] += Vec3(7000.1, -7000.2, 300.3);
    }
    return result;
}

Vec3 middle_of(const Tree& tree) {
    const geometry::Aabb& box = tree.nodes()[0].box;
    Vec3 middle(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
        middle[static_cast<int>(k)] =
            0.5 * (static_cast<double>(box.lower[k]) + static_cast<double>(box.upper[k]));
    }
    return middle;
}

/// Moves `origin` to where `count` of 3 coordinates are the target's, but for the one in which the
/// target is farthest from the middle: the ray then runs across an axis (1) or along one (2).
Vec3 aligned(Vec3 origin, const Vec3& target, const Vec3& middle, int count) {
    const Vec3 away = glm::abs(target - middle);
    const int longest = away.x >= away.y ? (away.x >= away.z ? 0 : 2) : (away.y >= away.z ? 1 : 2);
    for (int k = 1; k <= count; ++k) {
        origin[(longest + k) % 3] = target[(longest + k) % 3];
    }
    return origin;
}

/// Rays from points inside a closed mesh to its edges and vertices that hit nothing: traced by the
/// binary tree, and by wide trees one by one and in batches. Runs of rays from one point become
/// packets there.
std::size_t leaks_of(const Mesh& mesh,
                     double inner_radius,
                     std::uint64_t begin,
                     std::uint64_t end) {
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const WideTree wide = WideTree::build(tree, mesh.view());
    const Vec3 middle = middle_of(tree);
    std::size_t leaks = 0;
    std::vector<Ray> rays;
    for (std::uint64_t i = begin; i < end; ++i) {
        const auto& triangle = mesh.triangles[i % mesh.triangles.size()];
        const Vec3& a = mesh.positions[triangle[i % 3]];
        const Vec3& b = mesh.positions[triangle[(i + 1) % 3]];
        const double share = i % 7 == 0 ? 0.0 : random(17, 0, i);
        const Vec3 target = a + share * (b - a);
        const Vec3 inside = middle + inner_radius * test::random_point(18, i % 1000 < 500 ? i : 0);
        const int alignment = i % 5 == 0 ? static_cast<int>(i % 3) : 0;
        const Vec3 origin = aligned(inside, target, middle, alignment);
        const Ray ray{.origin = origin, .direction = target - origin};
        leaks += closest_hit(tree, mesh.view(), ray) ? 0 : 1;
        leaks += closest_hit(wide, mesh.view(), ray) ? 0 : 1;
        rays.push_back(ray);
    }
    const auto add_batch = [&](const WideTree& traced) {
        const auto hits = closest_hits(traced, mesh.view(), rays);
        leaks += static_cast<std::size_t>(std::count(hits.begin(), hits.end(), std::nullopt));
    };
    add_batch(wide);
    add_batch(WideTree::build(tree, mesh.view(), Executor::serial(), LeafEncoding::quantised));
    return leaks;
}

TEST(Watertight, NoRayLeavesASphereThroughEdgesOrVertices) {
    const auto places = in_three_places(test::sphere(4, 1.0, Vec3(0.0)));
    EXPECT_EQ(leaks_of(places[0], 0.5, 0, 100000), 0U);
    EXPECT_EQ(leaks_of(places[1], 0.06, 0, 100000), 0U);
    EXPECT_EQ(leaks_of(places[2], 0.5, 0, 100000), 0U);
}

TEST(Watertight, NoRayLeavesACubeThroughEdgesOrVertices) {
    // A half-width that is no binary fraction, so that the grid's coordinates are rounded.
    for (const int steps : {1, 7}) {
        const auto places = in_three_places(test::cube(steps, 0.3));
        EXPECT_EQ(leaks_of(places[0], 0.29, 0, 50000), 0U) << steps;
        EXPECT_EQ(leaks_of(places[1], 0.12, 0, 50000), 0U) << steps;
        EXPECT_EQ(leaks_of(places[2], 0.29, 0, 50000), 0U) << steps;
    }
}

TEST(SlowWatertight, OfTenMillionRaysNoneLeavesThroughEdgesOrVertices) {
    constexpr std::uint64_t kChunk = 45000;
    const auto places = in_three_places(test::sphere(5, 1.0, Vec3(0.0)));
    const double inner_radius[] = {0.5, 0.06, 0.5};
    std::vector<std::size_t> leaks(57, 1);  // a ray is traced in four ways
    Executor executor;
    executor.for_each(leaks.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            leaks[k] = leaks_of(places[k % 3], inner_radius[k % 3], k * kChunk, (k + 1) * kChunk);
        }
    });
    EXPECT_EQ(leaks, std::vector<std::size_t>(57, 0));
}

/// Per edge, lower vertex first: its triangles.
std::map<std::pair<VertexId, VertexId>, std::vector<std::size_t>> edges_of(const Mesh& mesh) {
    std::map<std::pair<VertexId, VertexId>, std::vector<std::size_t>> edges;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId from = mesh.triangles[i][k];
            const VertexId to = mesh.triangles[i][(k + 1) % 3];
            edges[{std::min(from, to), std::max(from, to)}].push_back(i);
        }
    }
    return edges;
}

TEST(Watertight, NoRaySlipsBetweenTwoTrianglesOfAScannedMesh) {
    const Mesh bunny = test::stanford_bunny();
    if (bunny.triangles.empty()) {
        GTEST_SKIP();
    }
    // Scans have holes, so the claim is local: where both triangles of an edge face the ray, a ray
    // to a point of the edge is stopped there or before.
    const auto edges = edges_of(bunny);
    for (const Mesh& mesh : in_three_places(bunny)) {
        const Tree tree = Tree::build(triangle_boxes(mesh.view()));
        std::size_t aimed = 0;
        std::size_t leaks = 0;
        std::uint64_t i = 0;
        for (const auto& [edge, triangles] : edges) {
            const Vec3& a = mesh.positions[edge.first];
            const Vec3 target = a + random(3, 0, ++i) * (mesh.positions[edge.second] - a);
            const Vec3 origin = mesh.positions[0] + test::random_point(4, i);
            const Ray ray{.origin = origin, .direction = target - origin};
            const auto facing = [&](std::size_t triangle) {
                const auto& [p, q, r] = mesh.triangles[triangle];
                const Vec3 normal = glm::cross(mesh.positions[q] - mesh.positions[p],
                                               mesh.positions[r] - mesh.positions[p]);
                return glm::dot(glm::normalize(normal), glm::normalize(ray.direction));
            };
            if (triangles.size() != 2 || facing(triangles[0]) * facing(triangles[1]) < 1e-4) {
                continue;
            }
            const auto hit = closest_hit(tree, mesh.view(), ray);
            leaks += hit && hit->t <= 1.0 + 1e-6 ? 0 : 1;
            ++aimed;
        }
        EXPECT_EQ(leaks, 0U);
        EXPECT_GT(aimed, 80000U);
    }
}

TEST(Watertight, ARayInThePlaneOfAFaceIsStoppedByItsNeighbour) {
    const Mesh mesh = test::cube(5, 0.3);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const auto along = static_cast<int>(i % 3);
        Ray ray{.origin = 0.3 * test::random_point(5, i)};
        ray.origin[along] = -1.0;
        ray.origin[(along + 1) % 3] = i % 2 == 0 ? 0.3 : -0.3;
        ray.direction = Vec3(0.0);
        ray.direction[along] = 1.0;
        const auto hit = closest_hit(tree, mesh.view(), ray);
        ASSERT_TRUE(hit) << "ray " << i;
        ASSERT_DOUBLE_EQ(hit->t, 0.7) << "ray " << i;
    }
}

}  // namespace
}  // namespace earshot::bvh
