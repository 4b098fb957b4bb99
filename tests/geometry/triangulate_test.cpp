// SPDX-License-Identifier: MIT
#include "earshot/geometry/triangulate.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/geometry/predicates.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

namespace earshot::geometry {
namespace {

std::vector<Triangle> triangulated(const std::vector<Vec3>& polygon) {
    std::vector<VertexId> corners(polygon.size());
    std::iota(corners.begin(), corners.end(), VertexId{0});
    return triangulate(polygon, corners);
}

/// Areas of the triangles along the polygon's normal: all positive and summing to the polygon's if
/// nothing overlaps, sticks out or is turned over.
void expect_covers(const std::vector<Vec3>& polygon, const std::string& label) {
    Vec3 whole(0.0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        whole += glm::cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
    const double size = std::sqrt(glm::dot(whole, whole));
    const std::vector<Triangle> triangles = triangulated(polygon);
    EXPECT_EQ(triangles.size(), polygon.size() - 2) << label;
    double sum = 0.0;
    for (const Triangle& t : triangles) {
        const Vec3 area = glm::cross(polygon[t[1]] - polygon[t[0]], polygon[t[2]] - polygon[t[0]]);
        EXPECT_GE(glm::dot(area, whole), 0.0) << label;
        sum += glm::dot(area, whole) / size;
    }
    EXPECT_NEAR(sum, size, 1e-12 * size) << label;
}

TEST(TriangulateInSpace, TriangleStaysAsItIs) {
    EXPECT_EQ(triangulated({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_TRUE(triangulated({{0, 0, 0}, {1, 0, 0}}).empty());
    EXPECT_TRUE(triangulated({}).empty());
}

TEST(TriangulateInSpace, ArrowIsCutAtItsNotch) {
    // A fan from corner 0 would cover ground outside the arrow.
    const std::vector<Vec3> arrow{{0, 2, 0}, {-1, -1, 0}, {0, 0, 0}, {1, -1, 0}};
    expect_covers(arrow, "arrow");
    const std::vector<Vec3> turned{arrow[1], arrow[2], arrow[3], arrow[0]};
    expect_covers(turned, "turned arrow");
}

TEST(TriangulateInSpace, CornersOnStraightEdgesAndKeyholes) {
    expect_covers({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}, "straight");
    // A square with a square hole, joined by a seam: corners 4 and 9, 3 and 10 coincide.
    expect_covers({{0, 0, 0},
                   {4, 0, 0},
                   {4, 4, 0},
                   {0, 4, 0},
                   {0, 0, 0},
                   {1, 1, 0},
                   {1, 3, 0},
                   {3, 3, 0},
                   {3, 1, 0},
                   {1, 1, 0}},
                  "keyhole");
}

TEST(TriangulateInSpace, StarsInAnyPlaneAreCovered) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const auto count = 4 + random_bits(seed, 0, 0) % 60;
        const Vec3 u = glm::normalize(Vec3(random_between(seed, 1, 0, -1.0, 1.0),
                                           random_between(seed, 1, 1, -1.0, 1.0),
                                           random_between(seed, 1, 2, -1.0, 1.0)));
        const Vec3 v = glm::normalize(glm::cross(u, Vec3(0.3, -0.5, 0.8)));
        std::vector<Vec3> star;
        for (std::uint64_t i = 0; i < count; ++i) {
            const double angle =
                2.0 * math::kPi * static_cast<double>(i) / static_cast<double>(count);
            const double radius = random_between(seed, 2, i, 0.2, 3.0);
            star.push_back(Vec3(1.0, 2.0, 3.0) +
                           radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        expect_covers(star, "seed " + std::to_string(seed));
    }
}

TEST(TriangulateInSpace, PolygonsThatCrossThemselvesStillEnd) {
    EXPECT_EQ(triangulated({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2U);
    EXPECT_EQ(triangulated(std::vector<Vec3>(7, Vec3(1.0))).size(), 5U);
}

// The corner at 14 is reflex, but the products of doubles in its turn say that it is convex; an
// inexact test would cut it off as an ear that is turned over.
TEST(TriangulateInSpace, NearlyCollinearCornersAreDecidedExactly) {
    __extension__ using Int128 = __int128;
    const std::vector<Vec3> polygon{
        {0.42, 0.41999999999999993, 0.0}, {14.0, 14.0, 0.0}, {23.3, 23.3, 0.0}, {0.0, 24.0, 0.0}};
    const auto inexact = [&](std::size_t i, std::size_t j, std::size_t k) {
        const Vec3 to_j = polygon[j] - polygon[i], to_k = polygon[k] - polygon[i];
        return to_j.x * to_k.y - to_j.y * to_k.x;
    };
    const auto exact = [&](std::size_t i, std::size_t j, std::size_t k) {
        // All coordinates are multiples of 2^-54 below 2^5.
        const auto grid = [](double x) { return static_cast<Int128>(x * 0x1p54); };
        const auto &p = polygon[i], &q = polygon[j], &r = polygon[k];
        return (grid(q.x) - grid(p.x)) * (grid(r.y) - grid(p.y)) -
               (grid(q.y) - grid(p.y)) * (grid(r.x) - grid(p.x));
    };
    ASSERT_GT(inexact(0, 1, 2), 0.0);
    ASSERT_TRUE(exact(0, 1, 2) < 0);
    const std::vector<Triangle> triangles = triangulated(polygon);
    ASSERT_EQ(triangles.size(), 2U);
    for (const auto& [a, b, c] : triangles) {
        EXPECT_TRUE(exact(a, b, c) > 0) << a << " " << b << " " << c;
    }
}

using Loop = std::vector<glm::dvec2>;
using Loops = std::vector<Loop>;

double doubled_area(const Loop& loop) {
    double area = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::dvec2& next = loop[(i + 1) % loop.size()];
        area += loop[i].x * next.y - loop[i].y * next.x;
    }
    return area;
}

// Areas that add up do not rule out overlaps; edges that pair up within the border do.
void expect_fills(const Loops& loops, EarOrder order) {
    Loop points;
    std::vector<IndexLoop> indices;
    double area = 0.0;
    std::set<std::pair<std::size_t, std::size_t>> border;
    for (const Loop& loop : loops) {
        IndexLoop& numbers = indices.emplace_back(loop.size());
        std::iota(numbers.begin(), numbers.end(), points.size());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            border.insert({numbers[i], numbers[(i + 1) % loop.size()]});
        }
        points.insert(points.end(), loop.begin(), loop.end());
        area += doubled_area(loop);
    }
    const auto triangles = triangulate(points, indices, order);
    EXPECT_EQ(triangles.size(), points.size() + 2 * (loops.size() - 1) - 2);
    std::map<std::pair<std::size_t, std::size_t>, int> uses;
    for (const auto& t : triangles) {
        const double part = doubled_area({points[t[0]], points[t[1]], points[t[2]]});
        EXPECT_GT(part, 0.0);
        area -= part;
        for (std::size_t i = 0; i < 3; ++i) {
            ++uses[{t[i], t[(i + 1) % 3]}];
        }
    }
    EXPECT_EQ(area, 0.0);
    for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1);
        const bool inside = uses.count({edge.second, edge.first}) != 0;
        EXPECT_NE(inside, border.count(edge) != 0);
    }
}

void expect_fills(const Loops& loops) {
    expect_fills(loops, EarOrder::successive);
    expect_fills(loops, EarOrder::shortest_diagonal);
}

bool is_ear(const Loop& points, const IndexLoop& loop, std::size_t i) {
    const std::size_t count = loop.size();
    const glm::dvec2& a = points[loop[(i + count - 1) % count]];
    const glm::dvec2& b = points[loop[i]];
    const glm::dvec2& c = points[loop[(i + 1) % count]];
    return orient2d(a, b, c) > 0 && std::none_of(loop.begin(), loop.end(), [&](std::size_t corner) {
               const glm::dvec2& p = points[corner];
               return p != a && p != b && p != c && orient2d(a, b, p) >= 0 &&
                      orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0;
           });
}

/// Ear clipping that tests every corner anew for every ear.
std::vector<std::array<std::size_t, 3>> clipped(const Loop& points, EarOrder order) {
    IndexLoop loop(points.size());
    std::iota(loop.begin(), loop.end(), std::size_t{0});
    std::vector<std::array<std::size_t, 3>> triangles;
    for (std::size_t next = 1; loop.size() >= 3;) {
        const std::size_t count = loop.size();
        std::size_t best = next % count;
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < count; ++k) {
            const bool is_successive = order == EarOrder::successive;
            const std::size_t i = is_successive ? (next + k) % count : k;
            const glm::dvec2 diagonal =
                points[loop[(i + 1) % count]] - points[loop[(i + count - 1) % count]];
            const double length = is_successive ? 0.0 : glm::dot(diagonal, diagonal);
            if (length < shortest && is_ear(points, loop, i)) {
                shortest = length;
                best = i;
            }
        }
        best = count == 3 && order == EarOrder::shortest_diagonal ? 1 : best;
        triangles.push_back(
            {loop[(best + count - 1) % count], loop[best], loop[(best + 1) % count]});
        loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
        next = best;
    }
    return triangles;
}

// Points on a coarse grid, so that many coincide or are collinear; most outlines cross themselves.
TEST(TriangulateLoops, CutsTheSameEarsAsTestingEveryCornerAnew) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const std::uint64_t size = 3 + random_bits(seed, 0, 0) % 40;
        const std::uint64_t grid = 3 + random_bits(seed, 0, 1) % 20;
        Loop points;
        for (std::uint64_t i = 0; i < size; ++i) {
            points.emplace_back(static_cast<double>(random_bits(seed, 1, i) % grid),
                                static_cast<double>(random_bits(seed, 2, i) % grid));
        }
        IndexLoop loop(points.size());
        std::iota(loop.begin(), loop.end(), std::size_t{0});
        for (const EarOrder order : {EarOrder::successive, EarOrder::shortest_diagonal}) {
            ASSERT_EQ(triangulate(points, {loop}, order), clipped(points, order)) << seed;
        }
    }
}

TEST(TriangulateLoops, FillsConvexAndConcavePolygons) {
    expect_fills({{{0, 0}, {10, 0}, {10, 10}, {0, 10}}});
    expect_fills({{{0, 0}, {60, 0}, {60, 30}, {30, 30}, {30, 60}, {0, 60}}});
    expect_fills({{{0, 0}, {9, 0}, {9, 9}, {6, 9}, {6, 3}, {3, 3}, {3, 9}, {0, 9}}});
}

TEST(TriangulateLoops, UsesCornersOnStraightRuns) {
    expect_fills({{{0, 0}, {3, 0}, {5, 0}, {10, 0}, {10, 4}, {10, 10}, {6, 10}, {0, 10}}});
}

TEST(TriangulateLoops, LeavesHolesOut) {
    const Loop outline = {{0, 0}, {100, 0}, {100, 100}, {0, 100}};
    expect_fills({outline, {{20, 20}, {20, 40}, {40, 40}, {40, 20}}});
    Loops grid = {outline};
    for (double u = 10; u < 90; u += 20) {
        for (double v = 10; v < 90; v += 20) {
            grid.push_back({{u, v}, {u, v + 10}, {u + 10, v + 10}, {u + 10, v}});
        }
    }
    expect_fills(grid);
}

TEST(TriangulateLoops, ShortestDiagonalCutsTheNarrowEnds) {
    // A trapezium whose corners 0 and 2 are 2.2 apart, 1 and 3 are 8.2.
    const Loop points{{0, 0}, {6, 0}, {2, 1}, {-2, 2}};
    const auto triangles = triangulate(points, {{0, 1, 2, 3}}, EarOrder::shortest_diagonal);
    EXPECT_EQ(triangles, (std::vector<std::array<std::size_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

}  // namespace
}  // namespace earshot::geometry
