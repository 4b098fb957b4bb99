// SPDX-License-Identifier: MIT
#include "earshot/bvh/surface_distance.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/sampled_distance.h"
#include <cmath>
#include <cstdint>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 23;

Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& position : mesh.positions) {
        position += by;
    }
    return mesh;
}

Mesh random_mesh(std::uint64_t stream, std::size_t triangles) {
    Mesh mesh;
    for (std::uint64_t i = 0; i < 3 * triangles; ++i) {
        mesh.positions.push_back({random(kSeed, stream, 3 * i),
                                  random(kSeed, stream, 3 * i + 1),
                                  random(kSeed, stream, 3 * i + 2)});
    }
    for (geometry::VertexId t = 0; t < triangles; ++t) {
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

/// A square of `cells` x `cells` cells in the plane y = 0.
Mesh plate_of(geometry::VertexId cells) {
    Mesh mesh;
    for (geometry::VertexId j = 0; j <= cells; ++j) {
        for (geometry::VertexId i = 0; i <= cells; ++i) {
            mesh.positions.push_back({i / double(cells), 0.0, j / double(cells)});
        }
    }
    const geometry::VertexId width = cells + 1;
    for (geometry::VertexId j = 0; j < cells; ++j) {
        for (geometry::VertexId i = 0; i < cells; ++i) {
            const geometry::VertexId a = j * width + i;
            mesh.triangles.push_back({a, a + width + 1, a + 1});
            mesh.triangles.push_back({a, a + width, a + width + 1});
        }
    }
    return mesh;
}

TEST(SurfaceDistance, HoldsWhatDenseSamplesFind) {
    constexpr int kSteps = 24;
    for (std::uint64_t i = 0; i < 30; ++i) {
        const Mesh a = random_mesh(2 * i, 1 + i % 7);
        const Mesh b = random_mesh(2 * i + 1, 1 + i % 5);
        const SurfaceDistance found = one_sided_distance(a.view(), b.view(), 1e-3);
        const test::SampledDistance sampled = test::sampled_distance(a, b, kSteps);
        EXPECT_LE(found.lower, found.upper) << i;
        EXPECT_LE(found.upper - found.lower, 1e-3) << i;
        // Samples are points of the surface; anywhere is within `spacing` of one.
        EXPECT_LE(sampled.largest, found.upper * (1.0 + 1e-12)) << i;
        EXPECT_GE(sampled.largest + sampled.spacing, found.lower) << i;
    }
}

TEST(SurfaceDistance, IsOneSided) {
    // A small square in the middle of a large one, above it.
    Mesh large{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {{0, 2, 1}, {0, 3, 2}}};
    Mesh small = large;
    for (Vec3& p : small.positions) {
        p = 0.1 * p + Vec3(0.0, 0.25, 0.0);
    }
    const SurfaceDistance down = one_sided_distance(small.view(), large.view(), 1e-4);
    EXPECT_NEAR(down.upper, 0.25, 1e-4);
    EXPECT_NEAR(down.lower, 0.25, 1e-15);
    EXPECT_NEAR(down.rms, 0.25, 1e-12);
    const double corner = std::sqrt(0.25 * 0.25 + 2 * 0.9 * 0.9);
    const SurfaceDistance up = one_sided_distance(large.view(), small.view(), 1e-4);
    EXPECT_NEAR(up.lower, corner, 1e-12);
    EXPECT_GE(up.upper, up.lower);
}

TEST(SurfaceDistance, IsSmallBetweenTriangulationsOfOnePlane) {
    const Mesh coarse = plate_of(1);
    const Mesh fine = plate_of(17);
    const SurfaceDistance found = one_sided_distance(coarse.view(), fine.view(), 0.01);
    EXPECT_NEAR(found.lower, 0.0, 1e-12);
    EXPECT_LE(found.upper, 0.01);
    const SurfaceDistance back = one_sided_distance(fine.view(), coarse.view(), 0.01);
    EXPECT_LE(back.upper, 0.01);
}

TEST(SurfaceDistance, OfASphereFromASmallerOneIsTheGap) {
    const Mesh outer = test::sphere(4, 1.0, Vec3(0.0));
    const Mesh inner = test::sphere(4, 0.9, Vec3(0.0));
    const SurfaceDistance found = one_sided_distance(outer.view(), inner.view(), 1e-3);
    EXPECT_GE(found.lower, 0.1 - 1e-12);  // at corners
    EXPECT_LE(found.upper, 0.101);
    EXPECT_NEAR(found.rms, 0.1, 1e-3);
}

TEST(SurfaceDistance, DoesNotDependOnThreads) {
    const Mesh a = test::sphere(5, 1.0, Vec3(0.0));
    const Mesh b = moved(test::sphere(3, 1.0, Vec3(0.0)), Vec3(0.01, 0.0, 0.02));
    Executor executor(3);
    const SurfaceDistance one = one_sided_distance(a.view(), b.view(), 1e-3);
    const SurfaceDistance three = one_sided_distance(a.view(), b.view(), 1e-3, executor);
    EXPECT_EQ(one.lower, three.lower);
    EXPECT_EQ(one.upper, three.upper);
    EXPECT_EQ(one.rms, three.rms);
}

TEST(SurfaceDistance, OfNothingIsNoneAndFromNothingInfinite) {
    const Mesh nothing;
    const Mesh plate = plate_of(2);
    EXPECT_EQ(one_sided_distance(nothing.view(), plate.view(), 0.1).upper, 0.0);
    EXPECT_EQ(one_sided_distance(plate.view(), nothing.view(), 0.1).lower,
              std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace earshot::bvh
