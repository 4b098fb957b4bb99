// SPDX-License-Identifier: MIT
#include "earshot/propagation/map_limit.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "map_room.h"
#include <cmath>
#include <limits>
#include <numbers>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// An empty room of 8 x 6 m, cut into cells.
struct EmptyRoom {
    Scene scene;
    Simulator simulator;
    AirTest air;

    EmptyRoom()
        : scene(make()), simulator(scene), air(scene, 0.0, simulator.ray_scene().bvh, 0.0) {}
    static Scene make() {
        Scene scene = shoebox_room({8, 3, 6});
        scene.sources.push_back({.name = "talker", .position = {1, 1.5, 1}});
        return scene;
    }
    MapLattice lattice(double step) const { return {MapRectangle{0, 0, 8, 6, 1.2}, step, air}; }
};

double distance_to_centre(const Vec3& point) {
    return std::hypot(point.x - 4.1, point.z - 2.9);
}

std::vector<double> field_values(const MapLattice& lattice) {
    std::vector<double> values;
    for (std::uint32_t row = 0; row < lattice.rows(); ++row) {
        for (std::uint32_t column = 0; column < lattice.columns(); ++column) {
            values.push_back(
                distance_to_centre({lattice.x_at(column + 0.5), 0.0, lattice.z_at(row + 0.5)}));
        }
    }
    return values;
}

MetricMap map_of_field(const EmptyRoom& room, double step, std::uint32_t size) {
    MetricMap map{.metrics = {MapMetric("sti", audio::Bands::octaves())},
                  .sources = {"talker"},
                  .lattice = room.lattice(step)};
    map.cells = coarsest_cells(map.lattice, size, room.air);
    map.exclusions.resize(map.cells.size());
    for (const MapCellPoint& cell : map.cells) {
        map.values.push_back({.value = distance_to_centre(cell.point), .standard_error = 0.01});
    }
    return map;
}

TEST(MapContour, OfADistanceIsACircle) {
    const EmptyRoom room;
    const MapLattice lattice = room.lattice(0.1);
    const auto lines = contour_lines(lattice, field_values(lattice), 2.0);
    ASSERT_EQ(lines.size(), 1U);
    const std::vector<Vec3>& circle = lines.front();
    EXPECT_EQ(circle.front(), circle.back());
    double length = 0.0;
    for (std::size_t i = 0; i < circle.size(); ++i) {
        // Linear interpolation over a cell errs by step^2 / (8 radius).
        EXPECT_NEAR(distance_to_centre(circle[i]), 2.0, 0.001);
        EXPECT_DOUBLE_EQ(circle[i].y, 1.2);
        length += i > 0 ? glm::length(circle[i] - circle[i - 1]) : 0.0;
    }
    EXPECT_NEAR(length, 4.0 * std::numbers::pi, 0.02);
}

TEST(MapContour, LinesEndAtTheBorderAndAtCellsWithoutAValue) {
    const EmptyRoom room;
    const MapLattice lattice = room.lattice(0.25);
    std::vector<double> values = field_values(lattice);
    // The circle of 3.5 m is cut by two walls.
    const auto arcs = contour_lines(lattice, values, 3.5);
    ASSERT_EQ(arcs.size(), 2U);
    for (const auto& arc : arcs) {
        EXPECT_NE(arc.front(), arc.back());
    }
    for (std::size_t row = 0; row < lattice.rows(); ++row) {
        values[row * lattice.columns() + 16] = std::numeric_limits<double>::quiet_NaN();
    }
    EXPECT_EQ(contour_lines(lattice, values, 2.0).size(), 2U);
    EXPECT_TRUE(contour_lines(lattice, values, 100.0).empty());
}

TEST(MapContour, ASaddleIsCutByItsMean) {
    const EmptyRoom room;
    const MapLattice lattice(MapRectangle{1, 1, 2, 2, 1.2}, 0.5, room.air);
    const std::vector<double> low = {1.0, 0.0, 0.0, 1.0};
    EXPECT_EQ(contour_lines(lattice, low, 0.6).size(), 2U);
    EXPECT_EQ(contour_lines(lattice, low, 0.4).size(), 2U);
    // Each line cuts off one corner: those above a mean below the level, those below it otherwise.
    const auto corners = contour_lines(lattice, low, 0.6);
    for (const auto& line : corners) {
        const Vec3 middle = 0.5 * (line.front() + line.back());
        EXPECT_LT(std::abs((middle.x - 1.5) - (middle.z - 1.5)), 1e-12);
    }
}

TEST(MapLimit, ShareOfAreaIsThatOfTheCircle) {
    const EmptyRoom room;
    const double share = std::numbers::pi * 4.0 / 48.0;
    for (const std::uint32_t size : {1U, 4U}) {
        const MetricMap map = map_of_field(room, 0.1, size);
        const auto inside =
            evaluate_limit(map, {.metric = 0, .value = 2.0, .is_minimum = false}, 0);
        // Cells are counted whole; coarse ones are interpolated.
        EXPECT_NEAR(inside.share, share, size == 1 ? 0.002 : 0.01);
        const auto outside = evaluate_limit(map, {.metric = 0, .value = 2.0}, 0);
        EXPECT_NEAR(outside.share + inside.share, 1.0, 1e-12);
        EXPECT_NEAR(*outside.worst, 0.0, 0.2);
        // 2 x 0.02 m about the circle.
        EXPECT_NEAR(inside.uncertain_share, 4.0 * std::numbers::pi * 0.04 / 48.0, 0.005);
        ASSERT_EQ(inside.contours.size(), 1U);
    }
}

TEST(MapLimit, InterpolationIsBilinearBetweenEqualCells) {
    const EmptyRoom room;
    MetricMap map = map_of_field(room, 0.25, 4);
    for (std::size_t k = 0; k < map.cells.size(); ++k) {
        map.values[k].value = 2.0 + 3.0 * map.cells[k].point.x - map.cells[k].point.z;
    }
    const std::vector<double> values = interpolated_values(map, 0, 0);
    for (std::uint32_t row = 2; row < map.lattice.rows() - 2; ++row) {
        for (std::uint32_t column = 2; column < map.lattice.columns() - 2; ++column) {
            EXPECT_NEAR(values[row * map.lattice.columns() + column],
                        2.0 + 3.0 * map.lattice.x_at(column + 0.5) - map.lattice.z_at(row + 0.5),
                        1e-12);
        }
    }
}

TEST(MapLimit, CellsWithoutAValueDoNotMeetIt) {
    const EmptyRoom room;
    MetricMap map = map_of_field(room, 0.5, 1);
    for (std::size_t k = 0; k < map.cells.size() / 2; ++k) {
        map.values[k].value.reset();
    }
    const auto result = evaluate_limit(map, {.metric = 0, .value = 0.0}, 0);
    EXPECT_NEAR(result.share, 0.5, 1e-12);
    EXPECT_NEAR(result.unknown_share, 0.5, 1e-12);
}

TEST(MapLimit, GivenPointsCountByTheirNumber) {
    MetricMap map{.metrics = {MapMetric("sti", audio::Bands::octaves())}, .sources = {"talker"}};
    for (int k = 0; k < 4; ++k) {
        map.cells.push_back({.cell = {.size = 0}, .point = Vec3(k, 1, 1)});
        map.exclusions.push_back(k == 3 ? PointExclusion::outside : PointExclusion::none);
        map.values.push_back(k == 3 ? MapValue{} : MapValue{.value = 0.5 + 0.1 * k});
    }
    const auto result = evaluate_limit(map, {.metric = 0, .value = 0.55}, 0);
    EXPECT_NEAR(result.share, 2.0 / 3.0, 1e-12);
    EXPECT_EQ(result.worst_cell, 0U);
    EXPECT_TRUE(result.contours.empty());
}

}  // namespace
}  // namespace earshot::propagation
