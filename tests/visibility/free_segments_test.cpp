// SPDX-License-Identifier: MIT
#include "earshot/visibility/free_segments.h"

#include "earshot/bvh/brute_force.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include "visibility/screens.h"

namespace earshot::visibility {
namespace {

using geometry::Ray;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 11;

TEST(FreeSegments, EndAtTheFirstTriangleBothWays) {
    const geometry::Mesh mesh = test::triangle_soup(kSeed, 500);
    const ViewRegion region = {Vec3(-2.0), Vec3(2.0)};
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        rays.push_back({test::random_point(kSeed, 2 * i), test::random_point(kSeed, 2 * i + 1)});
    }
    const auto segments = cast_free_segments({test::tree_of(mesh), mesh.view()}, rays, region);
    ASSERT_EQ(segments.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto ahead = bvh::brute_force::closest_hit(mesh.view(), rays[i]);
        const auto behind =
            bvh::brute_force::closest_hit(mesh.view(), {rays[i].origin, -rays[i].direction});
        ASSERT_EQ(segments[i].at_to, ahead ? ahead->triangle : kNoTriangle) << "ray " << i;
        ASSERT_EQ(segments[i].at_from, behind ? behind->triangle : kNoTriangle) << "ray " << i;
        if (ahead) {
            ASSERT_EQ(segments[i].segment.to, rays[i].origin + ahead->t * rays[i].direction);
        } else {
            // It ends on the border of the region, which is about the whole mesh.
            const Vec3 end = glm::abs(segments[i].segment.to);
            ASSERT_NEAR(std::max({end.x, end.y, end.z}), 2.0, 1e-12) << "ray " << i;
        }
    }
}

TEST(FreeSegments, AreEmptyOutsideOfTheBoxAndInAnEmptyMesh) {
    const ViewRegion region = {Vec3(-1.0), Vec3(1.0)};
    const std::vector<Ray> rays = {{Vec3(0.0), {1.0, 0.0, 0.0}}, {Vec3(3.0), {1.0, 0.0, 0.0}}};
    const auto segments = cast_free_segments({bvh::WideTree(), {}}, rays, region);
    ASSERT_EQ(segments.size(), 2U);
    EXPECT_FALSE(segments[0].is_valid());
    EXPECT_EQ(segments[0].segment.from, Vec3(-1.0, 0.0, 0.0));
    EXPECT_EQ(segments[0].segment.to, Vec3(1.0, 0.0, 0.0));
    EXPECT_EQ(segments[1].segment.from, segments[1].segment.to);
}

TEST(FreeSegments, AreShortenedAtBothEnds) {
    const auto shorter = shortened({{0.0, 3.0, 0.0}, {4.0, 0.0, 0.0}}, 1.0);
    EXPECT_NEAR(glm::length(shorter.from - Vec3(0.8, 2.4, 0.0)), 0.0, 1e-15);
    EXPECT_NEAR(glm::length(shorter.to - Vec3(3.2, 0.6, 0.0)), 0.0, 1e-15);
    const auto point = shortened({{0.0, 3.0, 0.0}, {4.0, 0.0, 0.0}}, 2.6);
    EXPECT_EQ(point.from, Vec3(2.0, 1.5, 0.0));
    EXPECT_EQ(point.to, point.from);
    const auto none = shortened({Vec3(1.0), Vec3(1.0)}, 0.0);
    EXPECT_EQ(none.from, Vec3(1.0));
    EXPECT_EQ(none.to, Vec3(1.0));
}

}  // namespace
}  // namespace earshot::visibility
