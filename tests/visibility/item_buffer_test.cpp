// SPDX-License-Identifier: MIT
#include "earshot/visibility/item_buffer.h"

#include "earshot/bvh/brute_force.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"
#include <cmath>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::TriangleId;
using geometry::Vec3;

/// A small triangle around each point, facing the origin.
Mesh marks(const std::vector<Vec3>& points) {
    Mesh mesh;
    for (const Vec3& point : points) {
        const Vec3 side = glm::normalize(glm::cross(
            point, std::abs(point.y) > std::abs(point.x) ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
        const Vec3 up = glm::normalize(glm::cross(side, point));
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        constexpr double kSize = 0.2;
        mesh.positions.insert(
            mesh.positions.end(),
            {point - kSize * (side + up), point + kSize * (side - up), point + kSize * 1.5 * up});
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

ItemBuffer render(const Mesh& mesh, const View& view) {
    Executor two(2);
    return render_item_buffer({wide_tree_of(mesh.view()), mesh.view()}, {0, 0, 0}, view, {}, two);
}

/// What is seen at fractions of the width, from the left, and of the height, from the top.
TriangleId at(const ItemBuffer& buffer, double across, double down) {
    const auto column = static_cast<std::size_t>(across * static_cast<double>(buffer.view.width));
    const auto row = static_cast<std::size_t>(down * static_cast<double>(buffer.view.height));
    return buffer.triangles[row * buffer.view.width + column];
}

TEST(ItemBuffer, HasEqualAnglesPerPixelInAPanorama) {
    const Mesh mesh =
        marks({{0, 0, -5}, {5, 0, 0}, {-5, 0, 0}, {0, 5, -5}, {0, -5, -5}, {1, 0, 5}});
    const ItemBuffer buffer = render(mesh, {.width = 400, .height = 200});
    EXPECT_EQ(at(buffer, 0.5, 0.5), 0U);   // -Z in the middle
    EXPECT_EQ(at(buffer, 0.75, 0.5), 1U);  // +X to its right
    EXPECT_EQ(at(buffer, 0.25, 0.5), 2U);  // -X to its left
    EXPECT_EQ(at(buffer, 0.5, 0.25), 3U);  // 45 degrees up
    EXPECT_EQ(at(buffer, 0.5, 0.75), 4U);  // 45 degrees down
    const double behind = (180.0 - std::atan2(1.0, 5.0) * 180.0 / math::kPi) / 360.0;
    EXPECT_EQ(at(buffer, 0.5 + behind, 0.5), 5U);
    EXPECT_EQ(at(buffer, 0.6, 0.2), kNoTriangle);
    EXPECT_EQ(buffer.distances[0], std::numeric_limits<double>::infinity());
    EXPECT_NEAR(buffer.distances[100 * 400 + 200], 5.0, 0.02);
}

TEST(ItemBuffer, IsAPerspectiveForAView) {
    // 90 degrees across: x / -z is -1 ... 1 over the width, and half of that over the height.
    const Mesh mesh = marks({{0, 0, -5}, {3, 0, -5}, {0, 2, -5}, {-4, -2, -5}, {5, 0, 0}});
    const ItemBuffer front = render(mesh, {.width = 600, .height = 300, .forward = Vec3{0, 0, -2}});
    EXPECT_EQ(at(front, 0.5, 0.5), 0U);
    EXPECT_EQ(at(front, 0.5 + 0.3, 0.5), 1U);
    EXPECT_EQ(at(front, 0.5, 0.5 - 0.4), 2U);
    EXPECT_EQ(at(front, 0.5 - 0.4, 0.5 + 0.4), 3U);
    const ItemBuffer right = render(mesh, {.width = 60, .height = 60, .forward = Vec3{1, 0, 0}});
    EXPECT_EQ(at(right, 0.5, 0.5), 4U);
}

TEST(ItemBuffer, LooksStraightUpAndDown) {
    const Mesh mesh = marks({{2, 5, 0}, {0, 5, 2}, {2, -5, 0}, {0, -5, -2}});
    const View view{.width = 200, .height = 200, .forward = Vec3{0, 3, 0}};
    const ItemBuffer up = render(mesh, view);
    EXPECT_EQ(at(up, 0.7, 0.5), 0U);
    EXPECT_EQ(at(up, 0.5, 0.3), 1U);
    const ItemBuffer down = render(mesh, {.width = 200, .height = 200, .forward = Vec3{0, -1, 0}});
    EXPECT_EQ(at(down, 0.7, 0.5), 2U);
    EXPECT_EQ(at(down, 0.5, 0.3), 3U);
}

// Rays start in the plane through the point: 8 m across, 2 m to the right is a quarter of the
// width.
TEST(ItemBuffer, IsParallelForAWidth) {
    const Mesh mesh = marks({{0, -5, 0}, {2, -3, 0}, {0, -5, 1}, {-3, -5, -1.5}});
    const View view{.width = 400, .height = 200, .forward = Vec3{0, -2, 0}, .parallel_width = 8.0};
    const ItemBuffer buffer = render(mesh, view);
    EXPECT_EQ(at(buffer, 0.5, 0.5), 0U);
    EXPECT_EQ(at(buffer, 0.75, 0.5), 1U);
    EXPECT_EQ(at(buffer, 0.5, 0.75), 2U);
    EXPECT_EQ(at(buffer, 0.5 - 3.0 / 8.0, 0.5 - 1.5 / 4.0), 3U);
    EXPECT_NEAR(buffer.distances[100 * 400 + 200], 5.0, 0.1);
    for (std::size_t i = 0; i < buffer.triangles.size(); i += 7) {
        EXPECT_EQ(buffer.directions[i], Vec3(0.0, -1.0, 0.0));
        const double x = ((static_cast<double>(i % 400) + 0.5) / 400.0 - 0.5) * 8.0;
        const double z = ((static_cast<double>(i / 400) + 0.5) / 200.0 - 0.5) * 4.0;
        const auto hit = bvh::brute_force::closest_hit(
            mesh.view(), {.origin = {x, 0.0, z}, .direction = {0.0, -1.0, 0.0}});
        EXPECT_EQ(buffer.triangles[i], hit ? hit->triangle : kNoTriangle) << i;
    }
}

TEST(ItemBuffer, HoldsTheClosestHitOfEveryPixel) {
    const Mesh mesh = scene_mesh("classroom");
    const auto tree = wide_tree_of(mesh.view());
    const Vec3 point{1.5, 1.2, 2.5};
    const ItemBuffer buffer =
        render_item_buffer({tree, mesh.view()}, point, {.width = 70, .height = 35});
    for (std::size_t i = 0; i < buffer.triangles.size(); ++i) {
        EXPECT_NEAR(glm::length(buffer.directions[i]), 1.0, 1e-15);
        const auto hit = bvh::brute_force::closest_hit(
            mesh.view(), {.origin = point, .direction = buffer.directions[i]});
        ASSERT_TRUE(hit);
        EXPECT_EQ(buffer.triangles[i], hit->triangle);
        EXPECT_EQ(buffer.distances[i], hit->t);
    }
}

}  // namespace
}  // namespace earshot::visibility
