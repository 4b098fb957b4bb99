// SPDX-License-Identifier: MIT
#include "earshot/visibility/air_cut.h"

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/tolerance.h"
#include "earshot/visibility/internal/side_nodes.h"
#include "earshot/visibility/internal/visibility_graph.h"
#include "earshot/visibility/reached_sides.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <cmath>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;

/// A mesh of welded vertices with its hierarchy.
class Model {
public:
    explicit Model(const Mesh& mesh) : positions_(mesh.positions) {
        const geometry::CleanMesh clean = geometry::clean(mesh.view());
        for (const TriangleId id : clean.kept) {
            const auto& [a, b, c] = mesh.triangles[id];
            triangles_.push_back({clean.weld[a], clean.weld[b], clean.weld[c]});
        }
        bvh_ = bvh::DeformableBvh(view());
    }
    geometry::MeshView view() const { return {positions_, triangles_}; }
    bvh::MeshBvh bvh() const { return bvh_.view(); }
    double tolerance() const { return geometry::coplanar_tolerance(view()); }

private:
    std::vector<Vec3> positions_;
    std::vector<Triangle> triangles_;
    bvh::DeformableBvh bvh_;
};

/// A rectangle from `origin` along u and v in n x m cells, its front where u x v points.
void add_plate(Mesh& mesh, const Vec3& origin, const Vec3& u, const Vec3& v, int n = 1, int m = 1) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (int j = 0; j <= m; ++j) {
        for (int i = 0; i <= n; ++i) {
            mesh.positions.push_back(origin + u * (double(i) / n) + v * (double(j) / m));
        }
    }
    const auto width = static_cast<geometry::VertexId>(n + 1);
    for (geometry::VertexId j = 0; j < static_cast<geometry::VertexId>(m); ++j) {
        for (geometry::VertexId i = 0; i < static_cast<geometry::VertexId>(n); ++i) {
            const geometry::VertexId a = first + j * width + i;
            mesh.triangles.push_back({a, a + 1, a + width + 1});
            mesh.triangles.push_back({a, a + width + 1, a + width});
        }
    }
}

/// A box in cells of the given number per side; fronts inside, or outside.
void add_box(Mesh& mesh, const Vec3& low, const Vec3& high, int n, bool inward) {
    const Vec3 size = high - low;
    const Vec3 x(size.x, 0.0, 0.0);
    const Vec3 y(0.0, size.y, 0.0);
    const Vec3 z(0.0, 0.0, size.z);
    const auto plate = [&](const Vec3& at, const Vec3& u, const Vec3& v) {
        inward ? add_plate(mesh, at, u, v, n, n) : add_plate(mesh, at, v, u, n, n);
    };
    plate(low, x, y);
    plate(low, y, z);
    plate(low, z, x);
    plate(low + z, y, x);
    plate(low + x, z, y);
    plate(low + y, x, z);
}

/// A room of 6 x 3 x 5 m with hollow walls of 0.3 m and twelve boxes. A slit of the given height
/// and 2 m length in the wall x = 0 leads into the wall.
struct HollowRoom {
    Mesh mesh;
    TriangleId inner = 0;  ///< triangles of the room's shell and of the boxes; then the outer shell
};

HollowRoom hollow_room(double slit) {
    HollowRoom room;
    const Vec3 size(6.0, 3.0, 5.0);
    add_box(room.mesh, Vec3(0.0), size, 8, true);
    if (slit > 0.0) {
        // In place of the wall x = 0: strips of the same corners around the slit from z = 1.5 to
        // 3.5 at a height of 1 m.
        std::erase_if(room.mesh.triangles, [&](const Triangle& t) {
            return std::all_of(t.begin(), t.end(), [&](geometry::VertexId v) {
                return room.mesh.positions[v].x == 0.0;
            });
        });
        const auto wall = [&](double y, double z, double height, double length) {
            add_plate(room.mesh, {0.0, y, z}, {0.0, height, 0.0}, {0.0, 0.0, length}, 8, 8);
        };
        wall(0.0, 0.0, 1.0, 5.0);
        wall(1.0, 0.0, slit, 1.5);
        wall(1.0, 3.5, slit, 1.5);
        wall(1.0 + slit, 0.0, 2.0 - slit, 5.0);
    }
    for (int i = 0; i < 12; ++i) {
        const Vec3 low(0.6 + 1.4 * (i % 4), 0.05 + 0.9 * (i / 6), 0.5 + 1.3 * (i % 3));
        add_box(room.mesh, low, low + Vec3(0.4, 0.5, 0.6), 2, false);
    }
    room.inner = static_cast<TriangleId>(room.mesh.triangles.size());
    add_box(room.mesh, Vec3(-0.3), size + 0.3, 8, false);
    return room;
}

struct Labels {
    std::size_t air_of_fronts = 0, fronts = 0;
    std::size_t solid_of_rest = 0, rest = 0;
};

Labels labels_of(const HollowRoom& room, const AirCut& cut) {
    Labels labels;
    for (TriangleId t = 0; t < room.mesh.triangles.size(); ++t) {
        const bool is_inner = t < room.inner;
        labels.fronts += is_inner ? 1 : 0;
        labels.air_of_fronts +=
            is_inner && cut.label_of_side[front_of(t)] == SideLabel::air ? 1 : 0;
        const SideId other = is_inner ? back_of(t) : back_of(t);  // the cavity, or a box's inside
        ++labels.rest;
        labels.solid_of_rest += cut.label_of_side[other] == SideLabel::solid ? 1 : 0;
    }
    return labels;
}

TEST(AirCutTest, SlitsIntoTheWallsLeaveTheWallsSolid) {
    // methods of Zhou et al. with seeds: up to 3 cm every side is right.
    for (const bool cluster : {false, true}) {
        for (const double slit : {0.0, 0.002, 0.01, 0.03}) {
            const HollowRoom room = hollow_room(slit);
            const Model model(room.mesh);
            ASSERT_EQ(model.view().triangles.size(), room.mesh.triangles.size());
            const AirCut cut =
                cut_air(model.bvh(),
                        std::vector<Vec3>{{2.9, 2.6, 2.4}},
                        {},
                        {.rays_per_node = 64, .cluster = cluster, .tolerance = model.tolerance()});
            const Labels labels = labels_of(room, cut);
            EXPECT_EQ(labels.air_of_fronts, labels.fronts) << slit << ' ' << cluster;
            EXPECT_EQ(labels.solid_of_rest, labels.rest) << slit << ' ' << cluster;
            EXPECT_FALSE(cut.is_open);
        }
    }
}

/// An open-top cup of sheets, over a source in a room.
std::pair<Mesh, TriangleId> cup_in_room(double depth) {
    Mesh mesh;
    add_box(mesh, Vec3(0.0), {6.0, 3.0, 5.0}, 4, true);
    const auto first = static_cast<TriangleId>(mesh.triangles.size());
    const Vec3 low(2.8, 1.8, 2.3);
    add_plate(mesh, low, {0.0, 0.0, 0.4}, {0.4, 0.0, 0.0}, 2, 2);
    const Vec3 up(0.0, depth, 0.0);
    add_plate(mesh, low, {0.4, 0.0, 0.0}, up, 2, 2);
    add_plate(mesh, low + Vec3(0.4, 0.0, 0.0), {0.0, 0.0, 0.4}, up, 2, 2);
    add_plate(mesh, low + Vec3(0.4, 0.0, 0.4), {-0.4, 0.0, 0.0}, up, 2, 2);
    add_plate(mesh, low + Vec3(0.0, 0.0, 0.4), {0.0, 0.0, -0.4}, up, 2, 2);
    return {mesh, first};
}

std::size_t air_sides(const AirCut& cut, TriangleId first) {
    return static_cast<std::size_t>(std::count(
        cut.label_of_side.begin() + front_of(first), cut.label_of_side.end(), SideLabel::air));
}

TEST(AirCutTest, BothSidesOfAnOpenCupAreAirAtASmallLambdaOnly) {
    for (const double depth : {0.1, 0.4, 0.75}) {
        const auto [mesh, first] = cup_in_room(depth);
        const Model model(mesh);
        const std::size_t sides = 2 * (mesh.triangles.size() - first);
        ASSERT_EQ(sides, 80U);
        const auto cut = [&](double lambda, bool cluster) {
            return cut_air(model.bvh(),
                           std::vector<Vec3>{{3.0, 1.2, 2.5}},
                           {},
                           {.rays_per_node = 64,
                            .cluster = cluster,
                            .lambda = lambda,
                            .tolerance = model.tolerance()});
        };
        EXPECT_EQ(air_sides(cut(0.01, false), first), sides) << depth;
        EXPECT_EQ(air_sides(cut(0.01, true), first), sides) << depth;
        EXPECT_LT(air_sides(cut(1.0, false), first), sides) << depth;
    }
}

TEST(AirCutTest, APanelIsAirOnBothSidesAndASealedBoxIsSolid) {
    Mesh mesh;
    add_box(mesh, Vec3(0.0), {6.0, 3.0, 5.0}, 4, true);
    const auto panel = static_cast<TriangleId>(mesh.triangles.size());
    add_plate(mesh, {2.0, 1.0, 2.0}, {1.0, 0.2, 0.0}, {0.0, 0.0, 1.0}, 2, 2);
    const auto box = static_cast<TriangleId>(mesh.triangles.size());
    add_box(mesh, {4.0, 0.5, 1.0}, {4.5, 1.0, 1.5}, 2, false);
    const Model model(mesh);
    const AirCut cut = cut_air(model.bvh(),
                               std::vector<Vec3>{{1.0, 1.0, 1.0}},
                               {},
                               {.rays_per_node = 64, .tolerance = model.tolerance()});
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        EXPECT_EQ(cut.label_of_side[front_of(t)], SideLabel::air) << t;
        const bool is_panel = t >= panel && t < box;
        EXPECT_EQ(cut.label_of_side[back_of(t)], is_panel ? SideLabel::air : SideLabel::solid) << t;
    }
    // The winding of the triangles does not matter.
    Mesh turned = mesh;
    for (TriangleId t = 0; t < mesh.triangles.size(); t += 2) {
        std::swap(turned.triangles[t][1], turned.triangles[t][2]);
    }
    const Model turned_model(turned);
    const AirCut again = cut_air(turned_model.bvh(),
                                 std::vector<Vec3>{{1.0, 1.0, 1.0}},
                                 {},
                                 {.rays_per_node = 64, .tolerance = turned_model.tolerance()});
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        EXPECT_EQ(again.label_of_side[front_of(t) + (t % 2 == 0 ? 1 : 0)],
                  cut.label_of_side[front_of(t)])
            << t;
    }
}

TEST(AirCutTest, AFloorUnderFurnitureThatStandsOnItIsPartlyAir) {
    Mesh mesh;
    add_box(mesh, Vec3(0.0), {6.0, 3.0, 5.0}, 1, true);
    add_box(mesh, {2.0, 0.0, 2.0}, {3.0, 1.0, 3.0}, 1, false);   // on the floor
    add_box(mesh, {4.0, -0.2, 2.0}, {4.5, 1.0, 3.0}, 1, false);  // through it
    const Model model(mesh);
    const AirCut cut = cut_air(model.bvh(),
                               std::vector<Vec3>{{1.0, 1.0, 1.0}},
                               {},
                               {.rays_per_node = 64, .tolerance = model.tolerance()});
    EXPECT_GT(cut.sampled_triangles, 0U);
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = model.bvh().corners(t);
        const bool is_hidden = std::max({a.y, b.y, c.y}) <= 0.0 && t >= 12;
        if (is_hidden) {
            EXPECT_EQ(cut.label_of_side[front_of(t)], SideLabel::solid) << t;
        } else {
            EXPECT_NE(cut.label_of_side[front_of(t)], SideLabel::solid) << t;
        }
        EXPECT_EQ(cut.label_of_side[back_of(t)], SideLabel::solid) << t;
    }
}

TEST(AirCutTest, PrintedFormTakesTheSurroundingsForOutside) {
    Mesh mesh;
    add_box(mesh, Vec3(0.0), Vec3(1.0), 3, false);
    add_box(mesh, Vec3(0.2), Vec3(0.6), 3, false);  // inside the other
    const Model model(mesh);
    const AirCut cut = cut_air(
        model.bvh(), {}, {}, {.rays_per_node = 64, .lambda = 1.0, .tolerance = model.tolerance()});
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        const SideLabel want = t < mesh.triangles.size() / 2 ? SideLabel::air : SideLabel::solid;
        EXPECT_EQ(cut.label_of_side[front_of(t)], want) << t;
        EXPECT_EQ(cut.label_of_side[back_of(t)], SideLabel::solid) << t;
    }
}

TEST(AirCutTest, WeightsAreFormFactors) {
    // Two unit squares that face each other at a distance of 1: form factor 0.199825 (Howell 1982).
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0});
    add_plate(mesh, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
    const Model model(mesh);
    const AirCutOptions options{.rays_per_node = 50000, .max_rays = 10'000'000};
    const SideNodes nodes(model.bvh(), options, Executor::serial());
    ASSERT_EQ(nodes.size(), 4U);
    VisibilityGraph graph(model.bvh(), nodes, options, Executor::serial());
    graph.sample_nodes();
    double between = 0.0;
    for (const VisibilityGraph::Weight& weight : graph.weights()) {
        between += weight.b < nodes.size() ? weight.value : 0.0;
    }
    EXPECT_NEAR(between, 0.199825, 0.003);  // three standard errors of 10^5 rays from each
}

TEST(AirCutTest, OpeningsTellTheFlowThroughThem) {
    // A slit of 2 m x 1 cm into the wall, and its cap.
    const HollowRoom room = hollow_room(0.01);
    const Model model(room.mesh);
    const Vec3 a(0.0, 1.0, 1.5), b(0.0, 1.01, 1.5), c(0.0, 1.01, 3.5), d(0.0, 1.0, 3.5);
    const Opening slit{.cap = {{a, b, c}, {a, c, d}}};
    // A cap over a part of a wall leads nowhere.
    const Vec3 up(0.0, 0.5, 0.0);
    const Opening wall{.cap = {{a + up, b + up, c + up}}};
    // One across the room parts air from air.
    const Opening gate{.cap = {{Vec3(3.0, 2.0, 1.0), Vec3(3.0, 2.5, 1.0), Vec3(3.0, 2.5, 4.0)}}};
    const AirCut cut = cut_air(model.bvh(),
                               std::vector<Vec3>{{2.9, 2.6, 2.4}},
                               std::vector<Opening>{slit, wall, gate},
                               {.tolerance = model.tolerance()});
    EXPECT_NEAR(cut.openings[0].area, 0.02, 1e-12);
    EXPECT_GT(cut.openings[0].leaking, 250U);
    EXPECT_EQ(cut.openings[0].escaping, 0U);
    EXPECT_NEAR(cut.openings[0].lower.z, 1.5, 0.1);
    EXPECT_NEAR(cut.openings[0].upper.z, 3.5, 0.1);
    EXPECT_EQ(cut.openings[1].blocked, cut.openings[1].rays);
    EXPECT_EQ(cut.openings[1].leaking, 0U);
    EXPECT_EQ(cut.openings[2].leaking, 0U);
    EXPECT_GE(cut.leak_area, 0.018);
    EXPECT_LE(cut.leak_area, 0.05);
}

TEST(AirCutTest, IsTheSameForAnyExecutor) {
    const HollowRoom room = hollow_room(0.03);
    const Model model(room.mesh);
    const std::vector<Vec3> points{{2.9, 2.6, 2.4}};
    const AirCutOptions options{.tolerance = model.tolerance()};
    Executor four(4);
    const AirCut one = cut_air(model.bvh(), points, {}, options);
    const AirCut many = cut_air(model.bvh(), points, {}, options, four);
    EXPECT_EQ(one.label_of_side, many.label_of_side);
    EXPECT_EQ(one.flow, many.flow);
    EXPECT_EQ(one.leak_area, many.leak_area);
    EXPECT_EQ(one.edges, many.edges);
}

TEST(ReachedSidesTest, TellsAirsWithWitnesses) {
    Mesh mesh;
    add_box(mesh, Vec3(0.0), {6.0, 3.0, 5.0}, 4, true);
    const auto other = static_cast<TriangleId>(mesh.triangles.size());
    add_box(mesh, {7.0, 0.0, 0.0}, {9.0, 3.0, 5.0}, 4, true);
    const auto box = static_cast<TriangleId>(mesh.triangles.size());
    add_box(mesh, {1.0, 0.5, 1.0}, {1.5, 1.0, 1.5}, 2, false);
    const Model model(mesh);
    const std::vector<Vec3> points{
        {3.0, 1.0, 2.0}, {8.0, 1.0, 1.0}, {4.0, 2.0, 1.0}, {1.2, 0.7, 1.3}};
    const ReachedSides sides = sample_reached_sides(model.bvh(), points);
    EXPECT_EQ(sides.airs, 3U);
    EXPECT_EQ(sides.air_of_point, (std::vector<std::uint32_t>{0, 1, 0, 2}));
    for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
        const std::uint32_t front = t >= other && t < box ? 1 : 0;
        EXPECT_EQ(sides.air_of_side[front_of(t)], front) << t;
        EXPECT_EQ(sides.air_of_side[back_of(t)], t >= box ? 2 : ReachedSides::kNone) << t;
        const geometry::Ray& witness = sides.witnesses[front_of(t)];
        const auto hit = model.bvh().closest_hit(witness);
        ASSERT_TRUE(hit) << t;
        EXPECT_EQ(hit->triangle, t);
        const auto [a, b, c] = model.bvh().corners(t);
        EXPECT_LE(glm::dot(glm::cross(b - a, c - a), witness.direction), 0.0) << t;
    }
    EXPECT_EQ(sides.back_share[0], 0.0);
    EXPECT_EQ(sides.back_share[3], 1.0);
    EXPECT_EQ(sides.escape_share[1], 0.0);
    Executor four(4);
    const ReachedSides again = sample_reached_sides(model.bvh(), points, {}, four);
    EXPECT_EQ(sides.air_of_side, again.air_of_side);
    EXPECT_EQ(sides.rays, again.rays);
}

TEST(ReachedSidesTest, WhatCoversAPartOfASideIsNotReachedThroughIt) {
    // A box that stands on a floor, and a partition that stands on it and parts the room in two.
    Mesh mesh;
    add_box(mesh, Vec3(0.0), {6.0, 3.0, 5.0}, 1, true);
    add_box(mesh, {1.0, 0.0, 2.0}, {1.5, 0.5, 2.5}, 1, false);
    add_box(mesh, {3.0, -0.1, -0.1}, {3.2, 3.1, 5.1}, 1, false);
    const Model model(mesh);
    const std::vector<Vec3> points{{1.0, 1.0, 1.0}, {5.0, 1.0, 1.0}};
    const ReachedSides sides =
        sample_reached_sides(model.bvh(), points, {.tolerance = model.tolerance()});
    EXPECT_EQ(sides.air_of_point, (std::vector<std::uint32_t>{0, 1}));
    for (TriangleId t = 12; t < 36; ++t) {
        EXPECT_EQ(sides.air_of_side[back_of(t)], ReachedSides::kNone) << t;
    }
}

}  // namespace
}  // namespace earshot::visibility
