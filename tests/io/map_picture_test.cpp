// SPDX-License-Identifier: MIT
#include "earshot/io/map_picture.h"

#include <gtest/gtest.h>

#include "support/box.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::io {
namespace {

using geometry::Vec3;
using propagation::MapMetric;
using propagation::MetricMap;

/// Given points in a row, with the values of a metric.
MetricMap row_of(const char* metric, const std::vector<std::optional<double>>& values) {
    MetricMap map{.metrics = {MapMetric(metric, audio::Bands::octaves())},
                  .sources = {"<talker>"},
                  .source_positions = {{1.0, 1.5, 0.5}}};
    for (std::size_t k = 0; k < values.size(); ++k) {
        map.cells.push_back({.cell = {.size = 0}, .point = Vec3(static_cast<double>(k), 1.2, 0.0)});
        map.exclusions.push_back(propagation::PointExclusion::none);
        map.values.push_back({.value = values[k]});
    }
    return map;
}

/// Relative luminance of sRGB (IEC 61966-2-1).
double luminance(const std::array<std::uint8_t, 3>& colour) {
    const auto linear = [](std::uint8_t value) {
        const double share = value / 255.0;
        return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2]);
}

TEST(MapLevels, AreStepsOfOneJustNoticeableDifference) {
    const MetricMap c80 = row_of("c80", {2.5, {}, 5.2});
    const std::vector<double> decibels = {2, 3, 4, 5, 6};
    EXPECT_EQ(map_levels({.map = c80}), decibels);
    const MetricMap sti = row_of("sti", {0.5, 0.55});
    const auto about_limit = map_levels({.map = sti, .limit = propagation::MapLimit{.value = 0.6}});
    ASSERT_EQ(about_limit.size(), 5U);
    EXPECT_NEAR(about_limit.front(), 0.48, 1e-12);
    EXPECT_NEAR(about_limit.back(), 0.6, 1e-12);
    const MetricMap t30 = row_of("t30", {0.9, 1.2});
    const auto factors = map_levels({.map = t30});
    EXPECT_LE(factors.front(), 0.9);
    EXPECT_GE(factors.back(), 1.2);
    for (std::size_t i = 0; i + 1 < factors.size(); ++i) {
        EXPECT_NEAR(factors[i + 1] / factors[i], 1.05, 1e-12);
    }
}

TEST(MapLevels, OfOneValueAndOfNoneAreOneStep) {
    EXPECT_EQ(map_levels({.map = row_of("c80", {3.0})}).size(), 2U);
    EXPECT_EQ(map_levels({.map = row_of("c80", {{}})}).size(), 2U);
    EXPECT_EQ(map_levels({.map = row_of("t30", {{}})}).size(), 2U);
}

TEST(MapLevels, AreFewWhereALimitIsFarFromAllValues) {
    for (const char* const metric : {"sti", "c80", "t30"}) {
        for (const double limit : {1e9, 1e-9, -1e9}) {
            const auto levels = map_levels({.map = row_of(metric, {0.5, 0.9}),
                                            .limit = propagation::MapLimit{.value = limit}});
            EXPECT_LE(levels.size(), 203U) << metric << ", " << limit;
            EXPECT_TRUE(std::is_sorted(levels.begin(), levels.end()));
            EXPECT_LE(levels.front(), std::min(0.5, limit));
            EXPECT_GE(levels.back(), std::max(0.9, limit) * (1.0 - 1e-6));
        }
    }
}

TEST(MapColour, LightnessOrdersTheSteps) {
    for (const std::size_t steps : {2U, 5U, 12U}) {
        for (std::size_t step = 0; step + 1 < steps; ++step) {
            EXPECT_LT(luminance(map_colour(step, steps)), luminance(map_colour(step + 1, steps)));
        }
    }
    EXPECT_EQ(map_colour(0, 1), map_colour(1, 3));
}

TEST(PlanSection, IsTheOutlineOfABoxAtAHeight) {
    geometry::Mesh box;
    for (int i = 0; i < 8; ++i) {
        box.positions.emplace_back(i & 1 ? 3.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 4.0 : 0.0);
    }
    box.triangles = test::box_triangles();
    double length = 0.0;
    for (const auto& [a, b] : plan_section(box.view(), 1.2)) {
        length += std::hypot(b[0] - a[0], b[1] - a[1]);
        for (const auto& [x, z] : {a, b}) {
            EXPECT_TRUE(x == 0.0 || x == 3.0 || z == 0.0 || z == 4.0);
        }
    }
    EXPECT_NEAR(length, 14.0, 1e-12);
    EXPECT_TRUE(plan_section(box.view(), 2.5).empty());
    // At a height of vertices, edges are met all or none.
    EXPECT_TRUE(plan_section(box.view(), 0.0).empty());
}

TEST(MapPicture, DrawsAxesScaleSourcesAndNames) {
    const MetricMap map = row_of("c80", {2.5, {}, 5.2});
    const std::string svg = draw_map_svg({.map = map, .title = "room & hall"});
    for (const char* part : {"<title>room &amp; hall</title>",
                             ">x, m<",
                             ">z, m<",
                             ">c80, dB<",
                             ">&lt;talker&gt;<",
                             ">6<",
                             "#d6d6d6"}) {
        EXPECT_NE(svg.find(part), std::string::npos) << part;
    }
    const Picture picture = draw_map_picture({.map = map, .title = "room"});
    EXPECT_EQ(picture.rgb.size(), 3 * picture.width * picture.height);
    std::size_t dark = 0, unknown = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
        dark += picture.rgb[i] == 0 && picture.rgb[i + 1] == 0 && picture.rgb[i + 2] == 0 ? 1 : 0;
        unknown += picture.rgb[i] == 214 && picture.rgb[i + 1] == 214 ? 1 : 0;
    }
    EXPECT_GT(dark, 1000U);                                  // frame and letters
    EXPECT_NEAR(static_cast<double>(unknown), 113.0, 10.0);  // a disc of 6 pixels
}

}  // namespace
}  // namespace earshot::io
