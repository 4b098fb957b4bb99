// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_triangles.h"

#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/wide_ray.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;
using support::Dice;

constexpr double kDegree = math::kPi / 180.0;

void add_quad(Mesh& mesh, const std::array<Vec3, 4>& corners) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& along, const Vec3& up) {
    add_quad(mesh, {corner, corner + along, corner + along + up, corner + up});
}

/// A box around the origin, every wall of count x count tiles that meet without gaps.
Mesh tiled_room(const Vec3& half, int count) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const auto corner = [&](int i, int k) {
                Vec3 at{0.0};
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                at[axis] = side * half[axis];
                at[u] = half[u] * (2 * i - count) / count;
                at[v] = half[v] * (2 * k - count) / count;
                return at;
            };
            for (int i = 0; i < count; ++i) {
                for (int k = 0; k < count; ++k) {
                    add_quad(
                        mesh,
                        {corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1)});
                }
            }
        }
    }
    return mesh;
}

VisibleTriangles seen_in(const Mesh& mesh,
                         const Vec3& point,
                         const VisibleTrianglesOptions& options = {}) {
    return visible_triangles({wide_tree_of(mesh.view()), mesh.view()}, point, options);
}

std::set<TriangleId> ids_of(const VisibleTriangles& visible) {
    std::set<TriangleId> ids;
    for (const VisibleTriangle& entry : visible.triangles) {
        ids.insert(entry.triangle);
    }
    return ids;
}

/// Every triangle stands once, in order, with a direction that proves it.
void expect_proofs(const VisibleTriangles& visible, const Mesh& mesh, const Vec3& point) {
    EXPECT_EQ(ids_of(visible).size(), visible.triangles.size());
    for (std::size_t i = 0; i < visible.triangles.size(); ++i) {
        const VisibleTriangle& entry = visible.triangles[i];
        EXPECT_NEAR(glm::length(entry.direction), 1.0, 1e-15);
        EXPECT_TRUE(i == 0 || visible.triangles[i - 1].triangle < entry.triangle);
        EXPECT_EQ(entry.pixels == 0, entry.solid_angle == 0.0);
        const auto hit = bvh::brute_force::closest_hit(
            mesh.view(), {.origin = point, .direction = entry.direction});
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->triangle, entry.triangle);
    }
}

TEST(VisibleTriangles, AreAllOfAClosedConvexRoom) {
    const Mesh room = tiled_room({3, 2, 5}, 12);
    for (const Vec3& point : {Vec3{0, 0, 0}, Vec3{2.9, -1.95, 4.7}}) {
        const VisibleTriangles visible = seen_in(room, point);
        EXPECT_EQ(visible.triangles.size(), room.triangles.size());
        EXPECT_EQ(visible.free_solid_angle, 0.0);
        EXPECT_TRUE(visible.is_complete);
        expect_proofs(visible, room, point);
    }
}

TEST(VisibleTriangles, HaveTheSolidAnglesOfTheClosedForm) {
    // From its middle, every wall of a cube covers a sixth of the sphere, and so do its tiles of
    // what the tile's corners say: with two tiles an edge, a quarter of that.
    const VisibleTriangles visible = seen_in(tiled_room({2, 2, 2}, 2), {0, 0, 0});
    ASSERT_EQ(visible.triangles.size(), 48U);
    std::uint64_t pixels = 0;
    for (std::size_t tile = 0; tile < 24; ++tile) {
        const VisibleTriangle &a = visible.triangles[2 * tile],
                              &b = visible.triangles[2 * tile + 1];
        EXPECT_NEAR(a.solid_angle + b.solid_angle, math::kPi / 6.0, 1e-12);
        pixels += a.pixels + b.pixels;
    }
    // Half a degree in the middle of a face whose half-width is 1.
    EXPECT_GE(static_cast<double>(pixels), 6.0 / std::pow(std::tan(0.25 * kDegree), 2));
    EXPECT_LE(pixels, visible.rays);
}

TEST(VisibleTriangles, BehindASlitAreThoseOfTheStrip) {
    // Two plates at z = -1 leave -0.05 < x < 0.05 free; from the origin that is |x| < 0.5 of the
    // wall at z = -10, whose tiles are narrower than a pixel.
    Mesh mesh;
    add_quad(mesh, {-100, -100, -1}, {99.95, 0, 0}, {0, 200, 0});
    add_quad(mesh, {0.05, -100, -1}, {99.95, 0, 0}, {0, 200, 0});
    constexpr double kWidth = 0.027, kHeight = 0.05;
    for (int i = -40; i < 40; ++i) {
        for (int k = -20; k < 20; ++k) {
            add_quad(mesh, {i * kWidth, k * kHeight, -10}, {kWidth, 0, 0}, {0, kHeight, 0});
        }
    }
    const std::set<TriangleId> ids = ids_of(seen_in(mesh, {0, 0, 0}));
    std::size_t inside = 0, outside = 0;
    for (TriangleId id = 4; id < mesh.triangles.size(); ++id) {
        double least = 9.0, most = -9.0;
        for (const geometry::VertexId corner : mesh.triangles[id]) {
            least = std::min(least, mesh.positions[corner].x);
            most = std::max(most, mesh.positions[corner].x);
        }
        if (least >= -0.5 && most <= 0.5) {
            ++inside;
            EXPECT_TRUE(ids.contains(id)) << id;
        } else if (least >= 0.5 || most <= -0.5) {
            ++outside;
            EXPECT_FALSE(ids.contains(id)) << id;
        }
    }
    EXPECT_EQ(inside, 36U * 40 * 2);
    EXPECT_EQ(outside, 42U * 40 * 2);
    for (TriangleId plate = 0; plate < 4; ++plate) {
        EXPECT_TRUE(ids.contains(plate));
    }
}

TEST(VisibleTriangles, NarrowerThanAPixelAreFound) {
    // Boards of 1 m and slats of 1 mm in turn, 10 m away, where a pixel is 87 mm wide.
    Mesh mesh;
    for (int i = -5; i < 5; ++i) {
        add_quad(mesh, {1.001 * i, -3, -10}, {1, 0, 0}, {0, 6, 0});
        add_quad(mesh, {1.001 * i + 1, -3, -10}, {0.001, 0, 0}, {0, 6, 0});
    }
    const auto slats = [](const VisibleTriangles& visible) {
        return std::count_if(visible.triangles.begin(),
                             visible.triangles.end(),
                             [](const VisibleTriangle& e) { return e.triangle % 4 >= 2; });
    };
    const VisibleTriangles swept = seen_in(mesh, {0.3, 0, 0}, {.refine = false});
    const VisibleTriangles refined = seen_in(mesh, {0.3, 0, 0});
    EXPECT_LT(slats(swept), 10);
    EXPECT_EQ(slats(refined), 20);
    EXPECT_EQ(refined.triangles.size(), 40U);
    expect_proofs(refined, mesh, {0.3, 0, 0});
    // What the sweep counts stays as it is.
    for (const VisibleTriangle& entry : swept.triangles) {
        EXPECT_EQ(refined.triangles[entry.triangle].pixels, entry.pixels);
    }
}

TEST(VisibleTriangles, AreFoundIfTheirCentroidsAreVisible) {
    // Needles of 10 micrometres by 1 mm in the air before one wall, 10 m away, each touching
    // nothing.
    Mesh mesh;
    add_quad(mesh, {-50, -50, -20}, {100, 0, 0}, {0, 100, 0});
    constexpr std::uint64_t kSeed = 8;
    Dice dice(kSeed);
    for (int i = 0; i < 200; ++i) {
        add_quad(
            mesh, {dice.between(-8, 8), dice.between(-8, 8), -10}, {0.00001, 0, 0}, {0, 0.001, 0});
    }
    const Vec3 point{0.1, 0.2, 0.3};
    const std::set<TriangleId> ids = ids_of(seen_in(mesh, point));
    for (TriangleId id = 2; id < mesh.triangles.size(); ++id) {
        const geometry::Triangle& t = mesh.triangles[id];
        const Vec3 middle =
            (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
        const auto hit = bvh::brute_force::closest_hit(
            mesh.view(), {.origin = point, .direction = middle - point});
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->triangle, id) << "seed " << kSeed;
        EXPECT_TRUE(ids.contains(id)) << "seed " << kSeed;
    }
}

TEST(VisibleTriangles, HoldAllThatRaysInAnyDirectionHit) {
    for (const std::string scene : {"classroom", "coupled_rooms"}) {
        const Mesh mesh = scene_mesh(scene);
        const Vec3 point = scene == "classroom" ? Vec3{1.5, 1.2, 2.5} : Vec3{2.0, 1.3, 1.7};
        const VisibleTriangles visible = seen_in(mesh, point);
        const std::set<TriangleId> ids = ids_of(visible);
        expect_proofs(visible, mesh, point);
        EXPECT_LT(ids.size(), mesh.triangles.size());
        constexpr std::uint64_t kSeed = 4;
        Dice dice(kSeed);
        for (int i = 0; i < 5000; ++i) {
            const Vec3 direction{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
            const auto hit = bvh::brute_force::closest_hit(
                mesh.view(), {.origin = point, .direction = direction});
            if (hit) {
                EXPECT_TRUE(ids.contains(hit->triangle)) << scene << " seed " << kSeed;
            }
        }
    }
}

TEST(VisibleTriangles, DoNotDependOnBuilderThreadsOrInstructions) {
    const Mesh mesh = scene_mesh("classroom");
    const Vec3 point{1.5, 1.2, 2.5};
    const VisibleTrianglesOptions options{.resolution = 3.0 * kDegree};
    const VisibleTriangles expected = seen_in(mesh, point, options);
    Executor two(2), eight(8);
    for (const auto builder : {bvh::Builder::lbvh, bvh::Builder::spatial_median}) {
        const auto tree = wide_tree_of(mesh.view(), {.builder = builder});
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            EXPECT_EQ(visible_triangles({tree, mesh.view()}, point, options, two), expected)
                << target;
            EXPECT_EQ(visible_triangles({tree, mesh.view()}, point, options, eight), expected)
                << target;
        }
        override_simd_target("auto");
    }
}

TEST(VisibleTriangles, StopAtTheLimitOfRays) {
    const Mesh mesh = scene_mesh("classroom");
    const Vec3 point{1.5, 1.2, 2.5};
    const VisibleTriangles swept = seen_in(mesh, point, {.refine = false});
    const VisibleTriangles some = seen_in(mesh, point, {.max_refining_rays = 3000});
    const VisibleTriangles all = seen_in(mesh, point);
    EXPECT_TRUE(swept.is_complete && all.is_complete);
    EXPECT_FALSE(some.is_complete);
    EXPECT_LE(swept.triangles.size(), some.triangles.size());
    EXPECT_LT(some.triangles.size(), all.triangles.size());
    EXPECT_LE(some.rays, all.rays);
}

TEST(VisibleTriangles, FromASurfaceAreProvedToo) {
    const Mesh room = tiled_room({3, 2, 5}, 3);
    for (const Vec3& point : {Vec3{0.5, -2, 0.25}, Vec3{3, 2, 5}, room.positions[5]}) {
        const VisibleTriangles visible = seen_in(room, point);
        EXPECT_FALSE(visible.triangles.empty());
        expect_proofs(visible, room, point);
    }
}

TEST(VisibleTriangles, AreNoneInAnEmptyMesh) {
    const VisibleTriangles nothing = seen_in({}, {0, 0, 0});
    EXPECT_TRUE(nothing.triangles.empty());
    EXPECT_NEAR(nothing.free_solid_angle, 4.0 * math::kPi, 1e-9);
    const double wrong = std::numeric_limits<double>::quiet_NaN();
    const double endless = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(seen_in(tiled_room({1, 1, 1}, 1), {wrong, 0, 0}).triangles.empty());
    EXPECT_TRUE(seen_in(tiled_room({1, 1, 1}, 1), {0, endless, 0}).triangles.empty());
}

}  // namespace
}  // namespace earshot::visibility
