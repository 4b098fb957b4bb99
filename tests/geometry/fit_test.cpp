// SPDX-License-Identifier: MIT
#include "earshot/geometry/fit.h"

#include "earshot/base/random.h"
#include "earshot/geometry/vector.h"

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "geometry/made_meshes.h"
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace earshot::geometry {
namespace {

std::vector<TriangleId> all(const Mesh& mesh) {
    std::vector<TriangleId> ids(mesh.triangles.size());
    std::iota(ids.begin(), ids.end(), 0U);
    return ids;
}

/// A rotation that is uniform over all (Shoemake 1992).
glm::dquat random_rotation(std::uint64_t seed) {
    const RandomStream random(seed, 1);
    const double a = random.at(0), b = 2.0 * std::acos(-1.0) * random.at(1),
                 c = 2.0 * std::acos(-1.0) * random.at(2);
    return {std::sqrt(a) * std::cos(c),
            std::sqrt(1.0 - a) * std::sin(b),
            std::sqrt(1.0 - a) * std::cos(b),
            std::sqrt(a) * std::sin(c)};
}

Mesh moved(Mesh mesh, const glm::dquat& rotation, const Vec3& by) {
    for (Vec3& position : mesh.positions) {
        position = rotation * position + by;
    }
    return mesh;
}

/// 1 where two directions agree or are opposite.
double alignment(const Vec3& a, const Vec3& b) {
    return std::abs(glm::dot(a, b));
}

void expect_frame(const std::array<Vec3, 3>& axes) {
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(
                glm::dot(axes[static_cast<std::size_t>(i)], axes[static_cast<std::size_t>(k)]),
                i == k ? 1.0 : 0.0,
                1e-7);
        }
    }
    EXPECT_GT(glm::dot(glm::cross(axes[0], axes[1]), axes[2]), 0.99);
}

Mesh rectangle(double width, double depth) {
    return {.positions = {{0, 0, 0}, {width, 0, 0}, {width, 0, depth}, {0, 0, depth}},
            .triangles = {{0, 2, 1}, {0, 3, 2}}};  // facing up
}

// A rectangle's standard deviations are its sides / sqrt(12).
TEST(Fit, AxesOfARectangleAreItsSides) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const glm::dquat turn = random_rotation(seed);
        const Vec3 by(3.0, -20.0, 7.0);
        const Mesh mesh = moved(rectangle(4.0, 1.5), turn, by);
        const PrincipalAxes axes = fit_axes(mesh.view(), all(mesh));
        EXPECT_NEAR(axes.area, 6.0, 1e-12);
        EXPECT_NEAR(glm::distance(axes.centroid, turn * Vec3(2.0, 0.0, 0.75) + by), 0.0, 2e-7);
        EXPECT_NEAR(axes.deviations.x, 4.0 / std::sqrt(12.0), 2e-7);
        EXPECT_NEAR(axes.deviations.y, 1.5 / std::sqrt(12.0), 2e-7);
        EXPECT_NEAR(axes.deviations.z, 0.0, 2e-7);
        EXPECT_NEAR(alignment(axes.axes[0], turn * Vec3(1, 0, 0)), 1.0, 1e-12);
        EXPECT_NEAR(alignment(axes.axes[1], turn * Vec3(0, 0, 1)), 1.0, 1e-12);
        expect_frame(axes.axes);
    }
}

// The second moments of a box's surface: per axis, two sides at a / 2, four with a^2 / 12.
TEST(Fit, AxesOfABoxFollowFromItsSurface) {
    const Vec3 s(3.0, 2.0, 1.0);
    const Mesh mesh = box_mesh(s, 3);
    const PrincipalAxes axes = fit_axes(mesh.view(), all(mesh));
    const double area = 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x);
    EXPECT_NEAR(axes.area, area, 1e-12);
    for (int k = 0; k < 3; ++k) {
        const double side = 2.0 * s[(k + 1) % 3] * s[(k + 2) % 3];
        const double square = s[k] * s[k];
        const double variance = (side * square / 4.0 + (area - side) * square / 12.0) / area;
        EXPECT_NEAR(axes.deviations[k], std::sqrt(variance), 1e-7);
    }
}

TEST(Fit, DoesNotDependOnHowASurfaceIsCut) {
    const glm::dquat turn = random_rotation(5);
    const Mesh coarse = moved(box_mesh({3.0, 2.0, 1.0}, 1), turn, {1, 2, 3});
    const Mesh fine = moved(box_mesh({3.0, 2.0, 1.0}, 7), turn, {1, 2, 3});
    const PrincipalAxes a = fit_axes(coarse.view(), all(coarse));
    const PrincipalAxes b = fit_axes(fine.view(), all(fine));
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(glm::distance(a.axes[k], b.axes[k]), 0.0, 1e-7);
    }
    EXPECT_NEAR(glm::distance(a.deviations, b.deviations), 0.0, 2e-7);
    EXPECT_NEAR(glm::distance(a.centroid, b.centroid), 0.0, 2e-7);
}

TEST(Fit, PlaneOfARectangleIsItsPlane) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const glm::dquat turn = random_rotation(seed);
        const Vec3 by(0.5, 30.0, -4.0);
        const Mesh mesh = moved(rectangle(2.0, 5.0), turn, by);
        const PlaneFit fit = fit_plane(mesh.view(), all(mesh));
        EXPECT_NEAR(glm::dot(fit.plane.normal, turn * Vec3(0, 1, 0)), 1.0, 1e-12);
        EXPECT_NEAR(fit.plane.distance(by), 0.0, 1e-6);
        EXPECT_NEAR(fit.rms_distance, 0.0, 2e-7);
        EXPECT_NEAR(fit.max_distance, 0.0, 1e-6);
        Mesh turned_over = mesh;
        for (Triangle& triangle : turned_over.triangles) {
            std::swap(triangle[0], triangle[1]);
        }
        const PlaneFit below = fit_plane(turned_over.view(), all(turned_over));
        EXPECT_NEAR(glm::dot(below.plane.normal, fit.plane.normal), -1.0, 1e-12);
    }
}

// A gabled roof of half-width 1 and height h: heights over the plan are uniform in 0 ... h.
TEST(Fit, PlaneTellsHowFarASurfaceIsFromIt) {
    constexpr double kHeight = 0.3;
    const Mesh roof{
        .positions =
            {{-1, 0, 0}, {-1, 0, 4}, {0, kHeight, 0}, {0, kHeight, 4}, {1, 0, 0}, {1, 0, 4}},
        .triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
    const PlaneFit fit = fit_plane(roof.view(), all(roof));
    EXPECT_NEAR(glm::distance(fit.plane.normal, {0.0, 1.0, 0.0}), 0.0, 1e-7);
    EXPECT_NEAR(fit.plane.offset, kHeight / 2.0, 1e-7);
    EXPECT_NEAR(fit.rms_distance, kHeight / std::sqrt(12.0), 1e-7);
    EXPECT_NEAR(fit.max_distance, kHeight / 2.0, 1e-7);
}

TEST(Fit, BoxOfABoxIsThatBox) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const RandomStream random(seed, 2);
        // Every fourth is a cube or a square prism, whose principal axes are undetermined.
        Vec3 size(0.2 + 3.0 * random.at(0), 0.2 + 3.0 * random.at(1), 0.2 + 3.0 * random.at(2));
        if (seed % 4 == 0) {
            size.y = size.x;
            size.z = seed % 8 == 0 ? size.x : size.z;
        }
        const glm::dquat turn = random_rotation(seed);
        const Vec3 by(10.0 * random.at(3), 10.0 * random.at(4), 10.0 * random.at(5));
        const Mesh mesh = moved(box_mesh(size, 1 + static_cast<int>(seed % 3)), turn, by);
        const OrientedBox box = fit_box(mesh.view(), all(mesh));
        std::array<double, 3> sides = {size.x, size.y, size.z};
        std::sort(sides.rbegin(), sides.rend());
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(2.0 * box.half_size[k], sides[static_cast<std::size_t>(k)], 1e-6) << seed;
        }
        EXPECT_NEAR(box.volume(), size.x * size.y * size.z, 1e-5) << seed;
        expect_frame(box.axes);
        Vec3 low(1e9), high(-1e9);
        for (const Vec3& position : mesh.positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
            for (int k = 0; k < 3; ++k) {
                EXPECT_LE(std::abs(glm::dot(position - box.centre,
                                            box.axes[static_cast<std::size_t>(k)])),
                          box.half_size[k] + 1e-6)
                    << seed;
            }
        }
        EXPECT_NEAR(glm::distance(box.centre, 0.5 * (low + high)), 0.0, 1e-6) << seed;
    }
}

TEST(Fit, BoxIsNeverLargerThanTheOneAlongTheAxes) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        Mesh mesh;
        const RandomStream random(seed, 3);
        for (std::uint64_t i = 0; i < 30; ++i) {
            mesh.positions.emplace_back(
                random.at(3 * i), 3.0 * random.at(3 * i + 1), random.at(3 * i + 2));
        }
        for (VertexId i = 0; i < 30; i += 3) {
            mesh.triangles.push_back({i, i + 1, i + 2});
        }
        const OrientedBox box = fit_box(mesh.view(), all(mesh));
        Vec3 low(1e9), high(-1e9);
        for (const Vec3& position : mesh.positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        const Vec3 size = high - low;
        EXPECT_LE(box.volume(), size.x * size.y * size.z * (1.0 + 1e-6));
        EXPECT_GE(box.half_size.x, box.half_size.y);
        EXPECT_GE(box.half_size.y, box.half_size.z);
    }
}

TEST(Fit, TakesPartsOfAMeshAndTrianglesWithoutArea) {
    Mesh mesh = rectangle(4.0, 1.5);
    mesh.positions.emplace_back(100.0, 100.0, 100.0);
    mesh.triangles.push_back({0, 1, 4});
    const std::vector<TriangleId> part = {0, 1};
    EXPECT_NEAR(fit_axes(mesh.view(), part).area, 6.0, 1e-12);
    mesh.triangles.push_back({0, 1, 1});
    const std::vector<TriangleId> flat = {3};
    const PrincipalAxes line = fit_axes(mesh.view(), flat);
    EXPECT_EQ(line.area, 0.0);
    EXPECT_EQ(line.axes[0], Vec3(1.0, 0.0, 0.0));
    EXPECT_NEAR(fit_box(mesh.view(), flat).half_size.x, 2.0, 1e-7);
    const Mesh point{.positions = {{1, 2, 3}}, .triangles = {{0, 0, 0}}};
    EXPECT_EQ(fit_box(point.view(), all(point)).centre, Vec3(1.0, 2.0, 3.0));
    EXPECT_EQ(fit_plane(point.view(), all(point)).max_distance, 0.0);
}

}  // namespace
}  // namespace earshot::geometry
