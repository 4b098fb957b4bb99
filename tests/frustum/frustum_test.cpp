// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/frustum.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace earshot::frustum {
namespace {

using geometry::Plane;
using geometry::Vec3;

Vec3 random_point(std::uint64_t seed, std::uint64_t stream, double size) {
    return {random_between(seed, stream, 0, -size, size),
            random_between(seed, stream, 1, -size, size),
            random_between(seed, stream, 2, -size, size)};
}

glm::dvec2 direction_in(const Frustum& frustum, const Vec3& point) {
    const Vec3 p = frustum.local(point);
    return {p.x / p.z, p.y / p.z};
}

bool holds(const Frustum& frustum, const Vec3& point) {
    if (frustum.local(point).z <= 0.0) {
        return false;
    }
    const glm::dvec2 uv = direction_in(frustum, point);
    return uv.x >= frustum.rect.lower.x && uv.x <= frustum.rect.upper.x &&
           uv.y >= frustum.rect.lower.y && uv.y <= frustum.rect.upper.y;
}

TEST(FrustaAround, CoverEveryDirection) {
    const Vec3 source = {1.0, -2.0, 0.5};
    for (const int pieces : {1, 3}) {
        const auto frusta = frusta_around(source, pieces, 8, 1e-9);
        EXPECT_EQ(frusta.size(), static_cast<std::size_t>(6 * pieces * pieces));
        for (std::uint64_t seed = 0; seed < 2000; ++seed) {
            Vec3 offset = random_point(seed, 0, 1.0);
            if (seed % 3 == 0) {
                offset.y = offset.x;  // on the border of two faces
            }
            int holders = 0;
            for (const Frustum& frustum : frusta) {
                holders += holds(frustum, source + offset) ? 1 : 0;
            }
            ASSERT_GE(holders, 1) << "seed " << seed;
        }
    }
}

TEST(Frustum, InverseDepthIsWhereRaysMeetThePlane) {
    const auto frusta = frusta_around({0.3, 0.2, 0.1}, 1, 8, 1e-9);
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Frustum& frustum = frusta[seed % 6];
        const Plane plane = {glm::normalize(random_point(seed, 1, 1.0)),
                             random_between(seed, 2, 0, 1.0, 3.0)};
        const InverseDepth depth = frustum.inverse_depth(plane);
        const glm::dvec2 uv = {random_between(seed, 3, 0, -1.0, 1.0),
                               random_between(seed, 3, 1, -1.0, 1.0)};
        const Vec3 direction = frustum.forward + uv.x * frustum.right + uv.y * frustum.up;
        const Vec3 point = frustum.apex + direction / depth.at(uv);
        EXPECT_NEAR(plane.distance(point), 0.0, 1e-9 * glm::length(point)) << "seed " << seed;
    }
}

TEST(Frustum, MirroringKeepsDirectionsOfPointsOnTheMirror) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Frustum frustum = frusta_around(random_point(seed, 0, 2.0), 1, 8, 1e-9)[seed % 6];
        const Plane plane = {glm::normalize(random_point(seed, 1, 1.0)), 5.0};
        const Frustum child = mirrored(frustum, plane, 7, frustum.rect);
        EXPECT_EQ(child.facet, 7U);
        EXPECT_NEAR(plane.distance(child.apex), -plane.distance(frustum.apex), 1e-12);
        const glm::dvec2 uv = {random_between(seed, 3, 0, -1.0, 1.0),
                               random_between(seed, 3, 1, -1.0, 1.0)};
        const double inverse = frustum.inverse_depth(plane).at(uv);
        if (inverse <= 0.0) {
            continue;
        }
        const Vec3 on_mirror =
            frustum.apex + (frustum.forward + uv.x * frustum.right + uv.y * frustum.up) / inverse;
        const glm::dvec2 seen = direction_in(child, on_mirror);
        EXPECT_NEAR(seen.x, uv.x, 1e-9) << "seed " << seed;
        EXPECT_NEAR(seen.y, uv.y, 1e-9) << "seed " << seed;
        EXPECT_NEAR(child.start.at(uv), inverse, 1e-9 * inverse);
        EXPECT_LE(child.min_depth, 1.0 / inverse);
        EXPECT_EQ(child.side, plane.distance(frustum.apex) > 0.0 ? 1.0 : -1.0);
    }
}

TEST(BoxCull, NeverCullsABoxWithAPointOfTheFrustum) {
    int culled = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        Frustum frustum = frusta_around(random_point(seed, 0, 1.0), 2, 8, 1e-9)[seed % 24];
        geometry::Aabb box;
        const Vec3 corner = random_point(seed, 1, 4.0);
        box.include(corner);
        box.include(corner + random_point(seed, 2, 1.5));
        const BoxCull cull(frustum, nullptr, 1e-12);
        if (cull.may_overlap(box)) {
            continue;
        }
        ++culled;
        for (std::uint64_t sample = 0; sample < 50; ++sample) {
            Vec3 point;
            for (int k = 0; k < 3; ++k) {
                const auto axis = static_cast<std::size_t>(k);
                point[k] = random_between(seed,
                                          3 + sample,
                                          axis,
                                          static_cast<double>(box.lower[axis]),
                                          static_cast<double>(box.upper[axis]));
            }
            ASSERT_FALSE(holds(frustum, point)) << "seed " << seed;
        }
    }
    EXPECT_GT(culled, 10000);
}

TEST(BoxCull, CullsWhatLiesBehindTheStartingFacet) {
    const Frustum root = frusta_around({0.0, 0.0, 0.0}, 1, 8, 1e-9)[4];  // towards +z
    const Plane mirror = {{0.0, 0.0, -1.0}, -2.0};                       // z = 2, facing the source
    const Frustum child = mirrored(root, mirror, 0, root.rect);
    const BoxCull cull(child, &mirror, 1e-12);
    geometry::Aabb behind, before;
    behind.include(Vec3(-0.1, -0.1, 2.5));
    behind.include(Vec3(0.1, 0.1, 3.0));
    before.include(Vec3(-0.1, -0.1, 0.5));
    before.include(Vec3(0.1, 0.1, 1.0));
    EXPECT_FALSE(cull.may_overlap(behind));
    EXPECT_TRUE(cull.may_overlap(before));
}

}  // namespace
}  // namespace earshot::frustum
