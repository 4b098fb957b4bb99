// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_share.h"

#include "earshot/base/math.h"
#include "earshot/visibility/line_of_sight.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"
#include <array>
#include <cmath>
#include <vector>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Vec3;
using support::Dice;

void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v) {
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (const Vec3& point : {corner, corner + u, corner + u + v, corner + v}) {
        mesh.positions.push_back(point);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

VisibleShare share_of(const Mesh& mesh,
                      const Vec3& from,
                      const SphereTarget& target,
                      const VisibleShareOptions& options = {}) {
    const auto tree = wide_tree_of(mesh.view());
    return VisibleShareQuery({tree, mesh.view()}).share(from, target, options);
}

TEST(VisibleShare, IsDecidedWithoutRaysWhereNothingOrOneWallIsBetween) {
    Mesh mesh;
    add_quad(mesh, {-10, -10, 2}, {20, 0, 0}, {0, 20, 0});
    const SphereTarget target{.centre = {0.3, 0.2, 4}, .radius = 1.5};
    // Behind the wall, whose diagonal crosses the ball's outline.
    const VisibleShare hidden = share_of(mesh, {0, 0, 0}, target);
    EXPECT_EQ(hidden, (VisibleShare{.share = 0.0, .error = 0.0, .rays = 0}));
    // On this side of it.
    const VisibleShare seen = share_of(mesh, {0, 0, 9}, target);
    EXPECT_EQ(seen, (VisibleShare{.share = 1.0, .error = 0.0, .rays = 0}));
    // Within the ball.
    EXPECT_EQ(share_of(mesh, {0, 0, 4}, target).share, 1.0);
}

// A half plane through the ball's axis hides half of it.
TEST(VisibleShare, IsHalfBehindAHalfPlane) {
    Mesh mesh;
    add_quad(mesh, {0, -100, 2}, {100, 0, 0}, {0, 200, 0});
    for (const std::size_t rays : {8U, 128U, 2048U, 32768U}) {
        const VisibleShare share =
            share_of(mesh, {0, 0, 0}, {.centre = {0, 0, 5}, .radius = 1}, {.max_rays = rays});
        EXPECT_NEAR(share.share, 0.5, share.error + 1e-12) << rays;
        EXPECT_LE(share.rays, rays / 2 + 8);
        EXPECT_LE(share.error, 2.7 / std::sqrt(static_cast<double>(rays)));
    }
}

// A wall that hides x > a hides of a disc, seen from far away, the segment beyond a chord.
TEST(VisibleShare, IsThatOfASegmentOfADisc) {
    constexpr double kAway = 1000.0;
    for (const double a : {-0.8, -0.3, 0.2, 0.7}) {
        Mesh mesh;
        add_quad(mesh, {a, -50, kAway - 2}, {100, 0, 0}, {0, 100, 0});
        const VisibleShare share =
            share_of(mesh, {0, 0, 0}, {.centre = {0, 0, kAway}, .radius = 1}, {.max_rays = 32768});
        const double hidden = (std::acos(a) - a * std::sqrt(1 - a * a)) / math::kPi;
        EXPECT_NEAR(share.share, 1.0 - hidden, share.error + 3e-3) << a;
        EXPECT_LT(share.error, 0.01);
    }
}

TEST(VisibleShare, OfAParallelogramIsThatOfItsArea) {
    Mesh mesh;
    add_quad(mesh, {-1, -1, 1}, {1, 0, 0}, {0, 2, 0});  // hides x < 0 of what is twice as far
    const auto tree = wide_tree_of(mesh.view());
    const VisibleShareQuery query({tree, mesh.view()});
    const ParallelogramTarget target{
        .corner = {-0.5, -0.5, 2}, .side_u = {2, 0, 0}, .side_v = {0, 1, 0}};
    const VisibleShare share = query.share({0, 0, 0}, target);
    EXPECT_NEAR(share.share, 0.75, share.error + 1e-12);
    EXPECT_LT(share.error, 0.03);
    const ParallelogramTarget hidden{
        .corner = {-0.9, -0.5, 2}, .side_u = {0.8, 0, 0}, .side_v = {0, 1, 0}};
    EXPECT_EQ(query.share({0, 0, 0}, hidden), (VisibleShare{}));
    const ParallelogramTarget open{
        .corner = {0.1, -0.5, 2}, .side_u = {0.8, 0, 0}, .side_v = {0, 1, 0}};
    EXPECT_EQ(query.share({0, 0, 0}, open), (VisibleShare{.share = 1.0}));
}

TEST(VisibleShare, KnowsTheExclusionMask) {
    Mesh mesh;
    add_quad(mesh, {-10, -10, 2}, {20, 0, 0}, {0, 20, 0});
    ExclusionMask mask;
    mask.add(0);
    const auto tree = wide_tree_of(mesh.view());
    const SphereTarget target{.centre = {0, 0, 4}, .radius = 1};
    // One of the wall's two triangles is left: it hides one half.
    const VisibleShare half = VisibleShareQuery({tree, mesh.view()}, mask).share({0, 0, 0}, target);
    EXPECT_NEAR(half.share, 0.5, half.error);
    mask.add(1);
    EXPECT_EQ(VisibleShareQuery({tree, mesh.view()}, mask).share({0, 0, 0}, target),
              (VisibleShare{.share = 1.0}));
}

Vec3 place_in(Dice& dice, double half_side) {
    const double x = dice.between(-half_side, half_side);
    const double y = dice.between(-half_side, half_side);
    return {x, y, dice.between(-half_side, half_side)};
}

/// A point of the part of a ball that faces `from`, by directions drawn within its cone and no
/// code of the library.
Vec3 random_point(const Vec3& from, const SphereTarget& ball, Dice& dice) {
    const Vec3 to_centre = ball.centre - from;
    const double distance = glm::length(to_centre);
    const Vec3 axis = to_centre / distance;
    const double sine = ball.radius / distance;
    const double lowest = std::sqrt(1.0 - sine * sine);
    for (;;) {
        // Directions in a cap by rejection from a cube about the axis.
        const Vec3 offset = place_in(dice, 1.0);
        const Vec3 across = offset - glm::dot(offset, axis) * axis;
        const double cosine = dice.between(lowest, 1.0);
        if (glm::dot(offset, offset) > 1.0 || glm::dot(across, across) < 1e-6) {
            continue;
        }
        const Vec3 direction =
            cosine * axis + std::sqrt(1.0 - cosine * cosine) * glm::normalize(across);
        const double middle = distance * cosine;
        const double half = std::sqrt(
            std::max(0.0, ball.radius * ball.radius - (distance * distance - middle * middle)));
        return from + (middle - half) * direction;
    }
}

/// Compares shares of random scenes with those of `rays` random rays each, whose own error is
/// added.
void compare_with_rays(int cases, int rays, std::uint64_t seed) {
    Dice dice(seed);
    int between = 0, decided = 0;
    for (int i = 0; i < cases; ++i) {
        Mesh mesh;
        const int walls = 1 + dice.below(6);
        for (int wall = 0; wall < walls; ++wall) {
            const Vec3 corner = place_in(dice, 3.0);
            const Vec3 u = place_in(dice, 2.0);
            add_quad(mesh, corner, u, place_in(dice, 2.0));
        }
        const Vec3 from = place_in(dice, 3.0);
        const Vec3 centre = place_in(dice, 3.0);
        const SphereTarget target{.centre = centre, .radius = dice.between(0.05, 2.0)};
        if (glm::distance(from, target.centre) < 1.01 * target.radius) {
            continue;
        }
        const auto tree = wide_tree_of(mesh.view());
        const bvh::MeshBvh bvh(tree, mesh.view());
        const VisibleShare share = VisibleShareQuery(bvh).share(from, target);
        int seen = 0;
        for (int ray = 0; ray < rays; ++ray) {
            seen += visible(bvh, {from, random_point(from, target, dice)}) ? 1 : 0;
        }
        const double expected = static_cast<double>(seen) / rays;
        // Five standard errors of the rays; where all agree, the rule of three.
        const double own = 5.0 * std::sqrt(expected * (1.0 - expected) / rays) + 6.0 / rays;
        EXPECT_NEAR(share.share, expected, share.error + own) << "case " << i << ", seed " << seed;
        if (share.rays == 0 && share.error == 0.0) {
            ++decided;
        }
        between += share.share > 0.0 && share.share < 1.0 ? 1 : 0;
    }
    EXPECT_GT(between, cases / 8);
    EXPECT_GT(decided, cases / 10);
}

TEST(VisibleShare, AgreesWithManyRays) {
    compare_with_rays(300, 1000, 1);
}

TEST(VisibleShare, AgreesWithManyMoreRaysSlow) {
    compare_with_rays(1000, 10000, 2);
}

TEST(VisibleShare, HasTheSameBitsForAnyThreads) {
    Mesh mesh;
    add_quad(mesh, {0, -1, 2}, {1, 0, 0}, {0, 2, 0});
    const auto tree = wide_tree_of(mesh.view());
    const VisibleShareQuery query({tree, mesh.view()});
    const std::vector<Vec3> from = {{0, 0, 0}, {0.5, 0, 0}, {-1, 0, 1}};
    const std::vector<Vec3> to = {{0, 0, 5}, {1, 1, 6}};
    Executor four(4);
    const auto serial = query.matrix(from, to, 0.5);
    EXPECT_EQ(serial, query.matrix(from, to, 0.5, {}, four));
    ASSERT_EQ(serial.size(), 6U);
    EXPECT_EQ(serial[3], query.share(from[1], SphereTarget{.centre = to[1], .radius = 0.5}));
}

}  // namespace
}  // namespace earshot::visibility
