// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_verifier.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"

namespace earshot::frustum {
namespace {

using geometry::FacetId;
using geometry::Vec3;

std::optional<SpecularPath> verify(const QuadRoom& room,
                                   const std::vector<FacetId>& sequence,
                                   const Vec3& source,
                                   const Vec3& listener) {
    const SceneView scene_view = room.scene_view();
    std::vector<Vec3> images = {source};
    for (const FacetId facet : sequence) {
        images.push_back(scene_view.facets.facets[facet].plane.mirror(images.back()));
    }
    return PathVerifier(scene_view).verify(sequence, images, listener);
}

/// A floor of 4 x 4 m at y = 0, front upwards.
QuadRoom floor_only(bool one_sided = false) {
    QuadRoom room;
    room.add_quad({0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}, one_sided);
    room.finish();
    return room;
}

TEST(PathVerifier, ReflectsOnTheFloor) {
    const auto path = verify(floor_only(), {0}, {1, 3, 2}, {3, 1, 2});
    ASSERT_TRUE(path);
    EXPECT_DOUBLE_EQ(path->length, std::sqrt(4.0 + 16.0));
    ASSERT_EQ(path->points.size(), 3U);
    EXPECT_NEAR(glm::distance(path->points[1], Vec3(2.5, 0.0, 2.0)), 0.0, 1e-12);
    EXPECT_EQ(path->triangles.size(), 1U);
}

TEST(PathVerifier, RefusesPointsPastTheBorderAndOnTheOtherSide) {
    EXPECT_TRUE(verify(floor_only(), {0}, {3, 1, 2}, {4.9, 1, 2}));
    EXPECT_FALSE(verify(floor_only(), {0}, {3, 1, 2}, {5.1, 1, 2}));
    EXPECT_FALSE(verify(floor_only(), {0}, {1, 3, 2}, {3, -1, 2}));
}

TEST(PathVerifier, TheBorderItselfReflects) {
    EXPECT_TRUE(verify(floor_only(), {0}, {3, 1, 2}, {5, 1, 2}));
    EXPECT_TRUE(verify(floor_only(), {0}, {3, 1, 3}, {5, 1, 5}));  // a corner
}

TEST(PathVerifier, AOneSidedFacetReflectsOnItsFrontOnly) {
    EXPECT_TRUE(verify(floor_only(false), {0}, {1, -3, 2}, {3, -1, 2}));
    EXPECT_FALSE(verify(floor_only(true), {0}, {1, -3, 2}, {3, -1, 2}));
    EXPECT_TRUE(verify(floor_only(true), {0}, {1, 3, 2}, {3, 1, 2}));
}

TEST(PathVerifier, SourcesInThePlaneDoNotReflect) {
    EXPECT_FALSE(verify(floor_only(), {0}, {1, 0, 2}, {3, 1, 2}));
    EXPECT_FALSE(verify(floor_only(), {0}, {1, 1e-15, 2}, {3, 1, 2}));
}

TEST(PathVerifier, AnythingThatTouchesALegBlocksIt) {
    const auto with_wall = [](double bottom) {
        QuadRoom room;
        room.add_quad({0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0});
        room.add_quad({2, bottom, 1}, {2, bottom, 3}, {2, 3, 3}, {2, 3, 1});
        room.finish();
        return room;
    };
    // The legs pass x = 2 at y = 0.5.
    const Vec3 source = {1, 1.5, 2};
    const Vec3 listener = {4, 1.5, 2};
    EXPECT_TRUE(verify(with_wall(0.501), {0}, source, listener));
    EXPECT_FALSE(verify(with_wall(0.499), {0}, source, listener));
    EXPECT_FALSE(verify(with_wall(0.5), {0}, source, listener));
}

TEST(PathVerifier, AMillimetreOpeningLetsSoundThrough) {
    QuadRoom room;
    room.add_quad({0, 0, 0}, {0, 0, 4}, {0, 2, 4}, {0, 2, 0});
    room.add_quad({0, 2.001, 0}, {0, 2.001, 4}, {0, 4, 4}, {0, 4, 0});
    room.finish();
    EXPECT_TRUE(verify(room, {}, {-1, 2.0005, 2}, {1, 2.0005, 2}));
    EXPECT_FALSE(verify(room, {}, {-1, 1.9995, 2}, {1, 1.9995, 2}));
}

TEST(PathVerifier, ACoplanarLayerDoesNotBlockTheFacetItLiesOn) {
    QuadRoom room = floor_only();
    room.add_quad({1, 0, 1}, {1, 0, 3}, {3, 0, 3}, {3, 0, 1});
    room.finish();
    EXPECT_TRUE(verify(room, {0}, {1, 3, 2}, {3, 1, 2}));
    EXPECT_TRUE(verify(room, {1}, {1, 3, 2}, {3, 1, 2}));
}

// With the source a hair over the plane and the listener a hair under it, both within rounding, the
// line through them meets the plane anywhere.
TEST(PathVerifier, GrazingWithinRoundingDoesNotReflectBeyondTheListener) {
    const double slack = 0x1p-42 * (4.0 + 0.2);
    EXPECT_FALSE(verify(floor_only(), {0}, {1, 1.1 * slack, 2}, {1.2, -0.9 * slack, 2}));
    EXPECT_FALSE(verify(floor_only(), {0}, {1, 7.0 * slack, 2}, {1.2, 7.0 * slack, 2}));
    EXPECT_TRUE(verify(floor_only(), {0}, {1, 9.0 * slack, 2}, {1.2, 9.0 * slack, 2}));
}

TEST(PathVerifier, OuterEdgesDoNotReflectLikeInnerOnes) {
    QuadRoom room;
    room.add_box({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    room.finish();
    std::size_t edges = 0;
    for (FacetId first = 0; first < 6; ++first) {
        for (FacetId second = 0; second < 6; ++second) {
            const Vec3 here = {2, 2, 0.5};  // the foot on the edge x = y = 1 is its middle
            EXPECT_FALSE(verify(room, {first, second}, here, here)) << first << ' ' << second;
            const Vec3 within = {0.25, 0.25, 0.5};
            edges += verify(room, {first, second}, within, within) ? 1 : 0;
        }
    }
    EXPECT_EQ(edges, 24U + 6U);  // twelve edges and three pairs of walls, either way round
}

// Seen along its facet's normal such a triangle is a line, and the point beyond its end is on no
// edge's outside.
TEST(PathVerifier, ASliverOnEdgeReflectsWhereItIsOnly) {
    geometry::Mesh mesh;
    mesh.positions = {
        {0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}, {5, 0, 2}, {6, 0, 2}, {5, 1e-7, 2}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
    geometry::Facets facets;
    facets.facets.resize(1);
    facets.facets[0].deviation = 1e-7;
    facets.facets[0].triangles = {0, 1, 2};
    facets.of_triangle = {0, 0, 0};
    facets.tolerance = 1e-6;
    const bvh::DeformableBvh bvh(
        mesh.view(), {.build = {.traversal_cost = 100.0}});  // one leaf, whose box tells nothing
    const PathVerifier verifier({.bvh = bvh.view(), .facets = facets, .one_sided = {}});
    const auto reflects_at = [&](double x) {
        const std::vector<Vec3> images = {{x - 1.0, 1.0, 2.0}, {x - 1.0, -1.0, 2.0}};
        const std::vector<FacetId> sequence = {0};
        return verifier.verify(sequence, images, {x + 1.0, 1.0, 2.0}).has_value();
    };
    EXPECT_TRUE(reflects_at(2.0));
    EXPECT_TRUE(reflects_at(5.5));
    EXPECT_FALSE(reflects_at(4.5));
}

}  // namespace
}  // namespace earshot::frustum
