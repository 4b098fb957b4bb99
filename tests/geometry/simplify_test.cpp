// SPDX-License-Identifier: MIT
#include "earshot/geometry/simplify.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/vector.h"

#include <gtest/gtest.h>

#include "made_meshes.h"
#include "support/meshes.h"
#include "support/sampled_distance.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace earshot::geometry {
namespace {

constexpr std::uint64_t kSeed = 41;

class Simplify : public ::testing::Test {
protected:
    void SetUp() override {
        if (!simplify_available()) {
            GTEST_SKIP() << "built without OpenMesh";
        }
    }
};

std::vector<std::uint32_t> no_labels(const Mesh& mesh) {
    return std::vector<std::uint32_t>(mesh.triangles.size(), 0);
}

using Edge = std::pair<VertexId, VertexId>;

std::map<Edge, int> edge_uses(const Mesh& mesh) {
    std::map<Edge, int> uses;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            ++uses[std::minmax(t[k], t[(k + 1) % 3])];
        }
    }
    return uses;
}

bool is_closed(const Mesh& mesh) {
    const auto uses = edge_uses(mesh);
    return std::all_of(
        uses.begin(), uses.end(), [](const auto& use) { return use.second % 2 == 0; });
}

double area(const Mesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = corners(mesh, t);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

double volume(const Mesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = corners(mesh, t);
        sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return sum;
}

double sampled_hausdorff(const Mesh& a, const Mesh& b, int steps) {
    return std::max(test::sampled_distance(a, b, steps).largest,
                    test::sampled_distance(b, a, steps).largest);
}

/// A ball whose surface is bumpy by `depth`.
Mesh bumpy_ball(int levels, double depth, std::uint64_t stream) {
    Mesh mesh = test::sphere(levels, 1.0, Vec3(0.0));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i] *= 1.0 + depth * random(kSeed, stream, i);
    }
    return mesh;
}

TEST_F(Simplify, LeavesABoxOfItsTwelveTriangles) {
    const Mesh box = box_mesh({4.0, 2.0, 8.0}, 8);
    const SimplifiedMesh result = simplify(box.view(), no_labels(box), {.max_distance = 0.0});
    EXPECT_EQ(result.mesh.triangles.size(), 12U);
    EXPECT_EQ(result.mesh.positions.size(), 8U);
    EXPECT_NEAR(volume(result.mesh), volume(box), 1e-12);
    EXPECT_TRUE(is_closed(result.mesh));
}

TEST_F(Simplify, KeepsASphereWithinTheDistanceAndClosed) {
    const Mesh ball = test::sphere(4, 1.0, Vec3(0.0));  // 2,048 triangles
    const SimplifiedMesh result = simplify(ball.view(), no_labels(ball), {.max_distance = 0.05});
    EXPECT_LT(result.mesh.triangles.size(), 300U);
    EXPECT_TRUE(is_closed(result.mesh));
    EXPECT_GT(volume(result.mesh), 0.85 * volume(ball));  // fronts are outside as before
    EXPECT_LE(sampled_hausdorff(ball, result.mesh, 3), 0.06);
}

TEST_F(Simplify, ALargerDistanceLeavesNoMoreTriangles) {
    const Mesh ball = bumpy_ball(4, 0.01, 1);
    std::size_t before = ball.triangles.size() + 1;
    for (const double distance : {0.0, 0.005, 0.02, 0.1}) {
        const SimplifiedMesh result =
            simplify(ball.view(), no_labels(ball), {.max_distance = distance});
        EXPECT_LT(result.mesh.triangles.size(), before) << distance;
        before = result.mesh.triangles.size();
    }
}

TEST_F(Simplify, AnglesBoundWhatMayBecomeFlat) {
    // The sides of a prism of 64 corners turn by 5.6 degrees each.
    Mesh tube;
    constexpr VertexId kSides = 64;
    for (VertexId i = 0; i < kSides; ++i) {
        const double angle = 2.0 * 3.14159265358979 * i / kSides;
        tube.positions.push_back({0.1 * std::cos(angle), 0.0, 0.1 * std::sin(angle)});
        tube.positions.push_back({0.1 * std::cos(angle), 1.0, 0.1 * std::sin(angle)});
    }
    for (VertexId i = 0; i < kSides; ++i) {
        const VertexId a = 2 * i;
        const VertexId b = 2 * ((i + 1) % kSides);
        tube.triangles.push_back({a, a + 1, b});
        tube.triangles.push_back({b, a + 1, b + 1});
    }
    const auto left = [&](double degrees) {
        return simplify(tube.view(),
                        no_labels(tube),
                        {.max_distance = 0.05, .max_angle = degrees * 3.14159265358979 / 180.0})
            .mesh.triangles.size();
    };
    EXPECT_EQ(left(1.0), tube.triangles.size());
    EXPECT_LT(left(30.0), tube.triangles.size() / 2);
    EXPECT_LT(left(90.0), left(30.0));
}

/// A cuboid whose edges and corners are rounded.
Mesh rounded_cuboid(const Vec3& half_size, double radius) {
    // A ball whose eighths are drawn apart; triangles between them become the sides.
    Mesh mesh = test::cube(12, 1.0);
    for (Triangle& triangle : mesh.triangles) {
        const auto [a, b, c] = corners(mesh.positions, triangle);
        if (glm::dot(glm::cross(b - a, c - a), a + b + c) < 0.0) {
            std::swap(triangle[1], triangle[2]);
        }
    }
    for (Vec3& p : mesh.positions) {
        const auto snapped = [&](double x, double half) {
            // The outer third of a side's cells becomes arcs.
            return std::abs(x) < 0.5 ? x / 0.5 * (half - radius) : std::copysign(half - radius, x);
        };
        const Vec3 core(
            snapped(p.x, half_size.x), snapped(p.y, half_size.y), snapped(p.z, half_size.z));
        Vec3 direction(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            direction[axis] = std::abs(p[axis]) < 0.5
                                  ? 0.0
                                  : std::copysign((std::abs(p[axis]) - 0.5) / 0.5, p[axis]);
        }
        p = core + radius * normalized_or_zero(direction);
    }
    return mesh;
}

TEST_F(Simplify, MakesRoundedEdgesSharpAndSidesFlat) {
    const Vec3 half(0.3, 0.2, 0.25);
    const Mesh round = rounded_cuboid(half, 0.01);
    ASSERT_TRUE(is_closed(round));
    const SimplifiedMesh result = simplify(round.view(), no_labels(round), {.max_distance = 0.012});
    // Of 1,728 triangles; the cuboid has 12, and a corner or two may stay blunt.
    EXPECT_LE(result.mesh.triangles.size(), 16U);
    const double cuboid = 8.0 * half.x * half.y * half.z;
    EXPECT_NEAR(volume(result.mesh), cuboid, 0.02 * cuboid);
    const SimplifiedMesh blunt =
        simplify(round.view(), no_labels(round), {.max_distance = 0.012, .sharpen = false});
    EXPECT_LT(volume(blunt.mesh), volume(result.mesh));
    EXPECT_LE(sampled_hausdorff(round, result.mesh, 3), 0.012);
}

TEST_F(Simplify, KeepsTheLinesBetweenLabels) {
    // A wall with a round patch of another material.
    Mesh wall;
    add_plate(wall, Vec3(0.0), {4.0, 0.0, 0.0}, {0.0, 0.0, -4.0}, 40, 40);
    std::vector<std::uint32_t> labels;
    double patch_area = 0.0;
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) {
        const auto [a, b, c] = corners(wall, t);
        const Vec3 centre = (a + b + c) / 3.0 - Vec3(2.0, 0.0, -2.0);
        labels.push_back(glm::length(centre) < 1.0 ? 7 : 3);
        patch_area += labels.back() == 7 ? 0.5 * glm::length(glm::cross(b - a, c - a)) : 0.0;
    }
    const SimplifiedMesh exact = simplify(wall.view(), labels, {.max_distance = 0.0});
    const SimplifiedMesh coarse = simplify(wall.view(), labels, {.max_distance = 0.15});
    EXPECT_LT(coarse.mesh.triangles.size(), exact.mesh.triangles.size());
    for (const SimplifiedMesh* result : {&exact, &coarse}) {
        double left = 0.0;
        Mesh patch{result->mesh.positions, {}};
        for (std::size_t t = 0; t < result->mesh.triangles.size(); ++t) {
            if (labels[result->origins[t]] == 7) {
                patch.triangles.push_back(result->mesh.triangles[t]);
            }
        }
        left = area(patch);
        EXPECT_NEAR(left, patch_area, result == &exact ? 1e-9 : 0.15 * 8.0);
        EXPECT_NEAR(area(result->mesh), 16.0, 1e-9);  // its outline has four corners
    }
}

TEST_F(Simplify, FillsNoNotchesOfBorders) {
    // An L-shaped sheet: its inner corner is close to nothing that would be made of it.
    Mesh sheet;
    add_plate(sheet, Vec3(0.0), {1.0, 0.0, 0.0}, {0.0, 0.0, -2.0}, 5, 10);
    add_plate(sheet, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 5, 5);
    const SimplifiedMesh result = simplify(sheet.view(), no_labels(sheet), {.max_distance = 0.1});
    EXPECT_EQ(result.mesh.triangles.size(), 4U);
    EXPECT_NEAR(area(result.mesh), 3.0, 1e-12);
}

TEST_F(Simplify, KeepsSheetsTogetherThatMeetInALine) {
    Mesh sheets;
    const Vec3 along(0.0, 0.0, -1.0);
    add_plate(sheets, Vec3(0.0), {1.0, 0.0, 0.0}, along, 8, 8);
    add_plate(sheets, Vec3(0.0), {-1.0, 0.125, 0.0}, along, 8, 8);
    add_plate(sheets, Vec3(0.0), {0.0, 1.0, 0.0}, along, 8, 8);
    const SimplifiedMesh result =
        simplify(sheets.view(), no_labels(sheets), {.max_distance = 0.01});
    EXPECT_LT(result.mesh.triangles.size(), 30U);
    EXPECT_LE(sampled_hausdorff(sheets, result.mesh, 2), 0.01);
    double length = 0.0;
    for (const auto& [edge, uses] : edge_uses(result.mesh)) {
        length += uses == 3 ? glm::length(result.mesh.positions[edge.first] -
                                          result.mesh.positions[edge.second])
                            : 0.0;
    }
    EXPECT_NEAR(length, 1.0, 1e-12);
}

TEST_F(Simplify, HolesOfFacetsStay) {
    // A wall with a window that is open.
    Mesh wall;
    add_plate(wall, Vec3(0.0), {4.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, 16, 16);
    Mesh open{wall.positions, {}};
    for (std::size_t t = 0; t < wall.triangles.size(); ++t) {
        const auto [a, b, c] = corners(wall, t);
        const Vec3 centre = (a + b + c) / 3.0;
        if (std::abs(centre.x - 2.0) > 0.5 || std::abs(centre.y - 2.0) > 0.75) {
            open.triangles.push_back(wall.triangles[t]);
        }
    }
    const SimplifiedMesh result = simplify(open.view(), no_labels(open), {.max_distance = 0.0});
    EXPECT_EQ(result.mesh.triangles.size(), 8U);
    EXPECT_NEAR(area(result.mesh), area(open), 1e-12);
}

TEST_F(Simplify, VerticesStayOrVanishUnlessItSharpens) {
    const Mesh ball = bumpy_ball(3, 0.05, 2);
    const SimplifiedMesh result =
        simplify(ball.view(), no_labels(ball), {.max_distance = 0.05, .sharpen = false});
    const auto less = [](const Vec3& a, const Vec3& b) { return lexicographic_less(a, b); };
    const std::set<Vec3, decltype(less)> vertices(
        ball.positions.begin(), ball.positions.end(), less);
    for (const Vec3& position : result.mesh.positions) {
        EXPECT_EQ(vertices.count(position), 1U);
    }
    ASSERT_EQ(result.origins.size(), result.mesh.triangles.size());
    for (const TriangleId origin : result.origins) {
        EXPECT_LT(origin, ball.triangles.size());
    }
}

TEST_F(Simplify, SurvivesRandomMeshesAndKeepsTheirLabels) {
    // Soups whose vertices are shared at random: crowded edges, pinched vertices, Moebius strips,
    // triangles without an area.
    for (std::uint64_t i = 0; i < 200; ++i) {
        const auto number = [&](std::uint64_t stream, std::uint64_t k) {
            return random_bits(kSeed + i, stream, k);
        };
        Mesh mesh;
        std::vector<std::uint32_t> labels;
        const std::uint64_t vertices = 4 + number(0, 0) % 40;
        for (std::uint64_t v = 0; v < vertices; ++v) {
            mesh.positions.push_back({static_cast<double>(number(1, v) % 8) / 4.0,
                                      static_cast<double>(number(2, v) % 8) / 4.0,
                                      static_cast<double>(number(3, v) % 3) / 4.0});
        }
        for (std::uint64_t t = 0; t < 5 + number(0, 1) % 120; ++t) {
            mesh.triangles.push_back({static_cast<VertexId>(number(4, 3 * t) % vertices),
                                      static_cast<VertexId>(number(4, 3 * t + 1) % vertices),
                                      static_cast<VertexId>(number(4, 3 * t + 2) % vertices)});
            labels.push_back(static_cast<std::uint32_t>(number(5, t) % 3));
        }
        const SimplifiedMesh result = simplify(mesh.view(), labels, {.max_distance = 0.05});
        std::set<std::uint32_t> before;
        std::set<std::uint32_t> after;
        for (const TriangleId kept : clean(mesh.view()).kept) {
            before.insert(labels[kept]);
        }
        for (const TriangleId origin : result.origins) {
            after.insert(labels[origin]);
        }
        EXPECT_EQ(before, after) << "mesh " << i;
        EXPECT_LE(result.mesh.triangles.size(), mesh.triangles.size()) << "mesh " << i;
    }
}

TEST_F(Simplify, ClosedRandomSurfacesStayClosed) {
    for (std::uint64_t i = 0; i < 20; ++i) {
        const Mesh ball = bumpy_ball(3, 0.02 * static_cast<double>(i), 100 + i);
        const SimplifiedMesh result =
            simplify(ball.view(), no_labels(ball), {.max_distance = 0.03});
        EXPECT_TRUE(is_closed(result.mesh)) << i;
        EXPECT_NEAR(volume(result.mesh), volume(ball), 0.03 * area(ball)) << i;
    }
}

TEST_F(Simplify, SaysWhichOptionIsWrong) {
    const Mesh box = box_mesh({1.0, 1.0, 1.0}, 1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(simplify(box.view(), no_labels(box), {.max_distance = -1.0}), Error);
    EXPECT_THROW(simplify(box.view(), no_labels(box), {.max_distance = nan}), Error);
    EXPECT_THROW(simplify(box.view(), no_labels(box), {.max_angle = 4.0}), Error);
    EXPECT_THROW(simplify(box.view(), no_labels(box), {.max_aspect_ratio = 0.5}), Error);
    EXPECT_THROW(simplify(box.view(), no_labels(box), {.samples_per_edge = -1}), Error);
}

TEST_F(Simplify, OfNothingIsNothing) {
    EXPECT_TRUE(simplify({}, {}).mesh.triangles.empty());
}

}  // namespace
}  // namespace earshot::geometry
