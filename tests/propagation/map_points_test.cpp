// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_points.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "map_room.h"
#include <algorithm>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// The distance of a point to the surface of a box, inside or outside.
double distance_to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
    const Vec3 beyond(std::max({low.x - p.x, 0.0, p.x - high.x}),
                      std::max({low.y - p.y, 0.0, p.y - high.y}),
                      std::max({low.z - p.z, 0.0, p.z - high.z}));
    if (beyond != Vec3(0.0)) {
        return glm::length(beyond);
    }
    return std::min(
        {p.x - low.x, high.x - p.x, p.y - low.y, high.y - p.y, p.z - low.z, high.z - p.z});
}

bool is_in_box(const Vec3& p, const Vec3& low, const Vec3& high) {
    return p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z > low.z &&
           p.z < high.z;
}

/// By the room's measures alone.
PointExclusion expected_at(const Vec3& p) {
    const Vec3 room(8, 3, 6), low(3, 0, 2), high(4, 1.5, 3);
    if (!is_in_box(p, Vec3(0.0), room)) {
        return PointExclusion::outside;
    }
    if (std::min(distance_to_box(p, Vec3(0.0), room), distance_to_box(p, low, high)) < 0.1) {
        return PointExclusion::near_surface;
    }
    return is_in_box(p, low, high) ? PointExclusion::in_solid : PointExclusion::none;
}

TEST(MapPoints, PointsOutsideInSolidsAndNearSurfacesAreLeftOutAndCounted) {
    const MapRoom room;
    const MapLattice lattice(MapRectangle{8.4, 6.2, -0.9, -0.4, 1.0}, 0.17, room.air);
    ExclusionCounts expected;
    for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
        for (std::uint32_t column = 0; column < lattice.columns(); ++column) {
            const Vec3 point(lattice.x_at(column + 0.5), 1.0, lattice.z_at(row + 0.5));
            const PointExclusion exclusion = expected_at(point);
            expected.add(exclusion);
            EXPECT_EQ(lattice.is_valid(0, column, row), exclusion == PointExclusion::none)
                << point.x << " " << point.z;
        }
    }
    EXPECT_EQ(lattice.excluded().outside, expected.outside);
    EXPECT_EQ(lattice.excluded().in_solid, expected.in_solid);
    EXPECT_EQ(lattice.excluded().near_surface, expected.near_surface);
    EXPECT_GT(expected.in_solid, 0U);
    EXPECT_GT(expected.near_surface, 0U);
}

TEST(MapPoints, CellsAreAtMostAsLargeAsTheStepAndFillTheRectangle) {
    const MapRoom room;
    const MapLattice lattice(MapRectangle{1, 1, 3, 2, 1.2}, 0.3, room.air);
    EXPECT_EQ(lattice.columns(), 7U);
    EXPECT_EQ(lattice.rows(), 4U);
    EXPECT_DOUBLE_EQ(lattice.cell_width(), 2.0 / 7.0);
    EXPECT_DOUBLE_EQ(lattice.x_at(7), 3.0);
    EXPECT_DOUBLE_EQ(lattice.z_at(4), 2.0);
    // A length that is a multiple of the step but for rounding.
    const MapLattice exact(MapRectangle{1, 1, 1.3, 1.3, 1.2}, 0.1, room.air);
    EXPECT_EQ(exact.columns(), 3U);
}

TEST(MapPoints, PointsStandAboveTheFacesOfAMaterialThatLookUp) {
    MapRoom room;
    const auto block = static_cast<std::uint32_t>(room.scene.materials.size() - 1);
    const MapLattice top(room.scene, 0.0, MapSurface{block, 0.4}, 0.25, room.air);
    EXPECT_EQ(top.columns(), 4U);
    EXPECT_EQ(top.sheets(), 1U);
    EXPECT_DOUBLE_EQ(top.height(0, 2, 1), 1.9);
    EXPECT_EQ(top.excluded().total(), 0U);
    // The floor is below the block, too.
    const MapLattice floor(room.scene, 0.0, MapSurface{0, 1.0}, 0.25, room.air);
    EXPECT_EQ(floor.sheets(), 1U);
    EXPECT_DOUBLE_EQ(floor.height(0, 0, 0), 1.0);
    EXPECT_EQ(floor.excluded().in_solid, 16U);
}

TEST(MapPoints, FacesAboveEachOtherAreSheetsOfTheirOwn) {
    MapRoom room;
    // The block's top becomes a part of the floor.
    for (std::uint32_t& material : room.scene.material_of_triangle) {
        material = material + 1 == room.scene.materials.size() ? 0 : material;
    }
    const MapLattice lattice(room.scene, 0.0, MapSurface{0, 1.0}, 0.5, room.air);
    ASSERT_EQ(lattice.sheets(), 2U);
    EXPECT_TRUE(lattice.is_valid(0, 0, 0));
    EXPECT_FALSE(lattice.is_valid(0, 6, 4));  // in the block
    EXPECT_TRUE(lattice.is_valid(1, 6, 4));   // above it
    EXPECT_DOUBLE_EQ(lattice.height(1, 6, 4), 2.5);
    const auto point = lattice.point_at(3.5, 2.4, 2.5, room.air);
    ASSERT_TRUE(point);
    EXPECT_DOUBLE_EQ(point->y, 2.5);
    EXPECT_FALSE(lattice.point_at(3.5, 1.2, 2.5, room.air));
}

TEST(MapPoints, EmptyAndHugeAreasAreErrors) {
    const MapRoom room;
    EXPECT_THROW(MapLattice(MapRectangle{1, 1, 1, 2, 1.2}, 0.1, room.air), Error);
    EXPECT_THROW(MapLattice(MapRectangle{0, 0, 8, 6, 1.2}, 1e-4, room.air), Error);
    EXPECT_THROW(MapLattice(MapRectangle{0, 0, 8, 6, 1.2}, 0.0, room.air), Error);
    // A wall does not look upwards.
    EXPECT_THROW(MapLattice(room.scene, 0.0, MapSurface{2, 1.0}, 0.1, room.air), Error);
}

}  // namespace
}  // namespace earshot::propagation
