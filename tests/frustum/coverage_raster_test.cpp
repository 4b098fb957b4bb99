// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/coverage_raster.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::frustum {
namespace {

using Polygon = std::vector<glm::dvec2>;

// Winding number by summed angles' sign changes would share code; this counts crossings of a
// horizontal ray, which is enough for simple polygons.
bool contains(const Polygon& polygon, const glm::dvec2& p) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const glm::dvec2& a = polygon[i];
        const glm::dvec2& b = polygon[j];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
            inside = !inside;
        }
    }
    return inside;
}

// A star-shaped polygon: simple, but not convex.
Polygon random_star(std::uint64_t seed) {
    Polygon polygon;
    const glm::dvec2 centre = {random_between(seed, 0, 0, -1.5, 1.5),
                               random_between(seed, 0, 1, -1.5, 1.5)};
    const int corners = 3 + static_cast<int>(random_bits(seed, 0, 2) % 7);
    const double size = std::exp2(random_between(seed, 0, 3, -5.0, 2.0));
    for (int i = 0; i < corners; ++i) {
        const double angle = 6.283185307179586 * i / corners;
        const double radius =
            size * random_between(seed, 1, static_cast<std::uint64_t>(i), 0.2, 1.0);
        polygon.push_back(centre + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    return polygon;
}

bool has(CellMask mask, int row, int column) {
    return ((mask >> (8 * row + column)) & 1) != 0;
}

TEST(CoverageRaster, OuterIsASupersetAndInnerASubset) {
    const Rect rect = {.lower = {-1.0, -1.0}, .upper = {1.0, 0.7}};
    int inner_cells = 0;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const Polygon polygon = random_star(seed);
        const int cells = 1 + static_cast<int>(seed % 8);
        CoverageRaster raster(rect, cells);
        raster.start(1e-9);
        raster.add_loop(polygon);
        const Coverage coverage = raster.finish();
        EXPECT_EQ(coverage.inner & ~coverage.outer, 0U);
        for (int row = 0; row < cells; ++row) {
            for (int column = 0; column < cells; ++column) {
                const Rect cell = raster.cell_rect(row, column);
                for (std::uint64_t sample = 0; sample < 20; ++sample) {
                    const auto key = static_cast<std::uint64_t>(64 * row + column) * 64 + sample;
                    const glm::dvec2 p = {random_between(seed, 2, key, cell.lower.x, cell.upper.x),
                                          random_between(seed, 3, key, cell.lower.y, cell.upper.y)};
                    if (contains(polygon, p)) {
                        ASSERT_TRUE(has(coverage.outer, row, column)) << "seed " << seed;
                    } else {
                        ASSERT_FALSE(has(coverage.inner, row, column)) << "seed " << seed;
                    }
                }
                inner_cells += has(coverage.inner, row, column) ? 1 : 0;
            }
        }
    }
    EXPECT_GT(inner_cells, 1000);  // inner must not be empty by being too careful
}

TEST(CoverageRaster, AHoleIsNotCovered) {
    CoverageRaster raster({.lower = {0.0, 0.0}, .upper = {8.0, 8.0}}, 8);
    raster.start(1e-9);
    raster.add_loop(Polygon{{-1.0, -1.0}, {9.0, -1.0}, {9.0, 9.0}, {-1.0, 9.0}});
    raster.add_loop(Polygon{{2.5, 2.5}, {2.5, 5.5}, {5.5, 5.5}, {5.5, 2.5}});
    const Coverage coverage = raster.finish();
    EXPECT_TRUE(has(coverage.inner, 0, 0));
    EXPECT_FALSE(has(coverage.outer, 3, 3));
    EXPECT_TRUE(has(coverage.outer, 2, 2));
    EXPECT_FALSE(has(coverage.inner, 2, 2));
}

TEST(CoverageRaster, PartsWoundTwiceAreStillInside) {
    CoverageRaster raster({.lower = {0.0, 0.0}, .upper = {8.0, 8.0}}, 8);
    raster.start(1e-9);
    const Polygon square = {{-1.0, -1.0}, {9.0, -1.0}, {9.0, 9.0}, {-1.0, 9.0}};
    raster.add_loop(square);
    raster.add_loop(square);
    EXPECT_EQ(raster.finish().inner, kAllCells);
}

TEST(CoverageRaster, SlackGrowsOuterAndShrinksInner) {
    // The polygon's right border lies 0.01 cells inside column 3.
    const Polygon square = {{-1.0, -1.0}, {3.01, -1.0}, {3.01, 9.0}, {-1.0, 9.0}};
    CoverageRaster raster({.lower = {0.0, 0.0}, .upper = {8.0, 8.0}}, 8);
    raster.start(1e-9);
    raster.add_loop(square);
    EXPECT_TRUE(has(raster.finish().inner, 4, 2));
    raster.start(0.02);
    raster.add_loop(square);
    EXPECT_FALSE(has(raster.finish().inner, 4, 2));
    EXPECT_TRUE(has(raster.finish().outer, 4, 2));
    EXPECT_FALSE(has(raster.finish().outer, 4, 4));
}

TEST(CoverageRaster, BoxesOutsideOverlapNoCell) {
    const CoverageRaster raster({.lower = {0.0, 0.0}, .upper = {8.0, 8.0}}, 8);
    EXPECT_EQ(raster.cells_overlapping({.lower = {8.1, 0.0}, .upper = {9.0, 8.0}}, 0.01), 0U);
    EXPECT_EQ(raster.cells_overlapping({.lower = {8.1, 0.0}, .upper = {9.0, 8.0}}, 0.2),
              row_bits(0, 7, 7) * 0x0101010101010101ULL);
    EXPECT_EQ(raster.cells_overlapping({.lower = {1.5, 2.5}, .upper = {3.5, 2.6}}, 0.0),
              row_bits(2, 1, 3));
}

TEST(CoverageRaster, CellsOverlappingAnotherGridAreThoseOfTheirRectangles) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto random_grid = [&](std::uint64_t stream) {
            const glm::dvec2 lower = {random_between(seed, stream, 0, -1.0, 0.5),
                                      random_between(seed, stream, 1, -1.0, 0.5)};
            const glm::dvec2 size = {random_between(seed, stream, 2, 0.01, 1.0),
                                     random_between(seed, stream, 3, 0.01, 1.0)};
            return CoverageRaster({.lower = lower, .upper = lower + size},
                                  1 + static_cast<int>(random_bits(seed, stream, 4) % 8));
        };
        const CoverageRaster grid = random_grid(0);
        const CoverageRaster other = random_grid(1);
        const CellMask cells = random_bits(seed, 2, 0) & random_bits(seed, 2, 1);
        const double slack = random_between(seed, 3, 0, 0.0, 0.5);
        CellMask expected = 0;
        for (int row = 0; row < grid.cells(); ++row) {
            for (int column = 0; column < grid.cells(); ++column) {
                const CellMask met =
                    other.cells_overlapping(grid.cell_rect(row, column), slack) & cells;
                expected |= met != 0 ? row_bits(row, column, column) : 0;
            }
        }
        EXPECT_EQ(grid.cells_overlapping_grid(other, cells, slack), expected) << "seed " << seed;
    }
}

TEST(CoverageRaster, ALoopThatGoesRoundManyTimesCoversWhatItDoesOnce) {
    const Polygon square = {{-0.3, 0.22}, {0.81, 0.22}, {0.81, 0.93}, {-0.3, 0.93}};
    CoverageRaster raster({.lower = {0.0, 0.0}, .upper = {1.0, 1.0}}, 8);
    raster.start(1e-9);
    raster.add_loop(square);
    const Coverage once = raster.finish();
    EXPECT_NE(once.inner, CellMask{0});
    for (const int turns : {127, 255, 256, 300, 512}) {
        Polygon loop;
        for (int turn = 0; turn < turns; ++turn) {
            loop.insert(loop.end(), square.begin(), square.end());
        }
        raster.start(1e-9);
        raster.add_loop(loop);
        const Coverage coverage = raster.finish();
        EXPECT_EQ(coverage.outer, once.outer) << turns;
        EXPECT_EQ(coverage.inner, once.inner) << turns;
        // As many times the other way: outside again.
        std::reverse(loop.begin(), loop.end());
        raster.add_loop(loop);
        EXPECT_EQ(raster.finish().centre_sampled, CellMask{0}) << turns;
    }
}

}  // namespace
}  // namespace earshot::frustum
