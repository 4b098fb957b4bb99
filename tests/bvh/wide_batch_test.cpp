// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_batch.h"

#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/wide_ray.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/query_meshes.h"
#include <atomic>
#include <cmath>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::MeshView;
using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

WideTree wide_tree_of(const Mesh& mesh) {
    return WideTree::build(Tree::build(triangle_boxes(mesh.view())), mesh.view());
}

/// Rows of rays from one point through a window, every other row backwards.
void add_camera(std::vector<Ray>& rays, const Vec3& eye, const Vec3& look, double window) {
    constexpr int kPixels = 24;
    const Vec3 right = glm::normalize(glm::cross(look, Vec3(0.1, 1.0, 0.2)));
    const Vec3 up = glm::cross(right, look);
    for (int y = 0; y < kPixels; ++y) {
        for (int x = 0; x < kPixels; ++x) {
            const int column = y % 2 == 0 ? x : kPixels - 1 - x;
            const double h = window * (column - kPixels / 2) / kPixels;
            const double v = window * (y - kPixels / 2) / kPixels;
            rays.push_back({.origin = eye, .direction = look + h * right + v * up});
        }
    }
}

/// Packets of all widths, with gaps, and rays of every other kind between them.
std::vector<Ray> mixed_rays(const Mesh& mesh, std::uint64_t seed) {
    std::vector<Ray> rays;
    const auto& p = mesh.positions;
    const double size = glm::distance(p[0], p[1]);
    std::uint64_t i = 0;
    for (const double window : {1e-9, 1e-4, 0.01, 0.1, 0.5, 2.0}) {
        const Vec3 target = p[random_bits(seed, 1, ++i) % p.size()];
        const Vec3 eye = target + 6.0 * size * test::random_point(seed, 100 + i);
        add_camera(rays, eye, target - eye, window * glm::distance(target, eye));
        for (int k = 0; k < 40; ++k) {
            const Vec3 from = p[random_bits(seed, 2, ++i) % p.size()];
            rays.push_back({from + size * test::random_point(seed, 200 + i),
                            size * test::random_point(seed, 300 + i)});
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 along(0.0);
        along[axis] = axis == 1 ? -size : size;
        add_camera(rays, p[static_cast<std::size_t>(axis)] - 3.0 * along, along, 0.02 * size);
    }
    for (std::size_t k = 0; k < rays.size(); ++k) {
        if (k % 13 == 0) {
            rays[k].t_max = 1.5 * random(seed, 3, k);
        }
        if (k % 97 == 5) {
            rays[k].direction[static_cast<int>(k % 3)] = k % 2 == 0 ? 0.0 : -0.0;
        }
        if (k % 101 == 7) {
            rays[k].origin.x = std::numeric_limits<double>::quiet_NaN();
        }
        if (k % 103 == 9) {
            rays[k].direction *= 1e40;
        }
    }
    return rays;
}

void expect_equal_answers(const Mesh& mesh, std::uint64_t seed, Executor& executor) {
    const WideTree wide = wide_tree_of(mesh);
    const std::vector<Ray> rays = mixed_rays(mesh, seed);
    const auto hits = closest_hits(wide, mesh.view(), rays, executor);
    std::vector<Segment> segments;
    for (const Ray& ray : rays) {
        segments.push_back({ray.origin, ray.origin + ray.direction});
    }
    const auto blocked = occluded(wide, mesh.view(), segments, executor);
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i], brute_force::closest_hit(mesh.view(), rays[i]))
            << "seed " << seed << ", ray " << i;
        found += hits[i] ? 1 : 0;
        if (!std::isnan(rays[i].origin.x)) {
            ASSERT_EQ(blocked[i] == 1, brute_force::occluded(mesh.view(), segments[i]))
                << "seed " << seed << ", segment " << i;
        }
    }
    EXPECT_GT(found, rays.size() / 20);
}

Mesh moved(Mesh mesh, double scale, const Vec3& offset) {
    for (Vec3& position : mesh.positions) {
        position = scale * position + offset;
    }
    return mesh;
}

TEST(WideBatch, EqualsBruteForceWithEverySimdTarget) {
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        expect_equal_answers(test::triangle_soup(1, 250), 1, Executor::serial());
    }
    override_simd_target("auto");
}

TEST(WideBatch, EqualsBruteForceOnFewTriangles) {
    Mesh doubled = test::cube(1, 1.0);
    doubled.triangles.resize(8);
    const auto once = doubled.triangles;
    doubled.triangles.insert(doubled.triangles.end(), once.rbegin(), once.rend());
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        expect_equal_answers(test::cube(1, 1.0), 31, Executor::serial());
        expect_equal_answers(doubled, 32, Executor::serial());
        expect_equal_answers(test::triangle_soup(33, 9), 33, Executor::serial());
        expect_equal_answers(moved(test::cube(1, 1.0), 1e6, Vec3(0.0)), 34, Executor::serial());
        expect_equal_answers(moved(test::cube(1, 1.0), 1e-30, Vec3(0.0)), 35, Executor::serial());
    }
    override_simd_target("auto");
}

TEST(WideBatch, EqualsBruteForceAtAnyScaleAndPlace) {
    const Mesh mesh = test::triangle_soup(2, 200);
    expect_equal_answers(moved(mesh, 1e-6, Vec3(0.0)), 2, Executor::serial());
    expect_equal_answers(moved(mesh, 1e6, Vec3(0.0)), 3, Executor::serial());
    expect_equal_answers(moved(mesh, 0.1, Vec3(1e4, -1e4, 3e3)), 4, Executor::serial());
    expect_equal_answers(moved(mesh, 1e-30, Vec3(0.0)), 5, Executor::serial());
}

TEST(WideBatch, EqualsBruteForceOnClosedAndFlatMeshes) {
    expect_equal_answers(test::cube(6, 1.0), 6, Executor::serial());
    expect_equal_answers(test::sphere(3, 2.0, Vec3(1.0)), 7, Executor::serial());
    Mesh doubled = test::cube(4, 1.0);
    const auto once = doubled.triangles;
    for (int copy = 0; copy < 7; ++copy) {
        doubled.triangles.insert(doubled.triangles.end(), once.rbegin(), once.rend());
    }
    expect_equal_answers(doubled, 8, Executor::serial());
}

TEST(WideBatch, IsTheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::triangle_soup(9, 3000);
    const WideTree wide = wide_tree_of(mesh);
    std::vector<Ray> rays;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const auto more = mixed_rays(mesh, 10 + seed);
        rays.insert(rays.end(), more.begin(), more.end());
    }
    const auto serial = closest_hits(wide, mesh.view(), rays);
    for (const int threads : {2, 8}) {
        Executor executor(threads);
        EXPECT_EQ(closest_hits(wide, mesh.view(), rays, executor), serial);
    }
}

TEST(WideBatch, AnswersInTheOrderOfTheRaysForAnyExecutor) {
    constexpr std::uint64_t kSeed = 31;
    constexpr std::size_t kCount = 1500;
    for (const test::QueryMesh& of : test::query_meshes(kSeed)) {
        const MeshView mesh = of.mesh.view();
        const WideTree wide = wide_tree_of(of.mesh);
        std::vector<Ray> rays;
        std::vector<Segment> segments;
        for (std::size_t i = 0; i < kCount; ++i) {
            rays.push_back(test::query_ray(of, kSeed, i));
            segments.push_back({rays[i].origin, rays[i].origin + rays[i].direction});
        }
        for (const int threads : {1, 2, 8}) {
            Executor executor(threads);
            const auto hits = closest_hits(wide, mesh, rays, executor);
            const auto blocked = occluded(wide, mesh, segments, executor);
            ASSERT_EQ(hits.size(), kCount);
            ASSERT_EQ(blocked.size(), kCount);
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_EQ(hits[i], closest_hit(wide, mesh, rays[i])) << of.name << i;
                ASSERT_EQ(blocked[i] != 0, occluded(wide, mesh, segments[i])) << of.name << i;
            }
        }
    }
}

TEST(WideBatch, WithoutRaysThereAreNoAnswers) {
    const Mesh mesh = test::cube(2, 0.5);
    const WideTree wide = wide_tree_of(mesh);
    EXPECT_TRUE(closest_hits(wide, mesh.view(), {}).empty());
    EXPECT_TRUE(occluded(wide, mesh.view(), std::span<const Segment>{}).empty());
}

TEST(WideBatch, FindsNothingInAnEmptyScene) {
    const Mesh mesh;
    const WideTree wide = wide_tree_of(mesh);
    const std::vector<Ray> rays(3);
    const std::vector<Segment> segments(3);
    EXPECT_EQ(closest_hits(wide, mesh.view(), rays), std::vector<std::optional<geometry::Hit>>(3));
    EXPECT_EQ(occluded(wide, mesh.view(), segments), std::vector<std::uint8_t>(3, 0));
}

TEST(WideBatch, StopsWhenItIsInterrupted) {
    const Mesh mesh = test::triangle_soup(1, 100);
    const WideTree wide = wide_tree_of(mesh);
    std::vector<Ray> rays(100000, {Vec3(0.1), Vec3(1.0, 0.2, 0.3)});
    std::vector<Segment> segments(rays.size(), {Vec3(0.1), Vec3(1.0)});
    std::vector<std::optional<geometry::Hit>> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    for (const int threads : {1, 2}) {
        Executor executor(threads);
        std::atomic<int> asked = 0;
        const Interrupt third_time = [&] { return ++asked >= 3; };
        EXPECT_FALSE(closest_hits(wide, mesh.view(), rays, hits, executor, third_time));
        EXPECT_LT(asked, 6);
        asked = 0;
        EXPECT_FALSE(occluded(wide, mesh.view(), segments, blocked, executor, third_time));
        EXPECT_LT(asked, 6);
        const Interrupt never = [] { return false; };
        EXPECT_TRUE(closest_hits(wide, mesh.view(), rays, hits, executor, never));
        EXPECT_EQ(hits, closest_hits(wide, mesh.view(), rays));
        EXPECT_TRUE(occluded(wide, mesh.view(), segments, blocked, executor, never));
        EXPECT_EQ(blocked, occluded(wide, mesh.view(), segments));
    }
}

}  // namespace
}  // namespace earshot::bvh
