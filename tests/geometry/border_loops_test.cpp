// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/border_loops.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include "geometry/facet_checks.h"
#include "geometry/made_meshes.h"
#include <algorithm>
#include <cstddef>
#include <vector>

namespace earshot::geometry {
namespace {

TEST(BorderLoops, OfAnLShapedFloorHaveSixCorners) {
    Mesh mesh;
    const Vec3 x(1.0, 0.0, 0.0);
    const Vec3 z(0.0, 0.0, 1.0);
    add_plate(mesh, Vec3(0.0), 4.0 * z, 2.0 * x, 4, 2);
    add_plate(mesh, Vec3(2.0, 0.0, 0.0), 2.0 * z, 3.0 * x, 2, 3);
    const Facets result = facets_of(mesh);
    ASSERT_EQ(result.facets.size(), 1U);
    EXPECT_EQ(result.facets[0].plane.normal, Vec3(0.0, 1.0, 0.0));
    EXPECT_EQ(result.facets[0].loops,
              (std::vector<Loop>{{Vec3(0.0, 0.0, 0.0),
                                  Vec3(0.0, 0.0, 4.0),
                                  Vec3(2.0, 0.0, 4.0),
                                  Vec3(2.0, 0.0, 2.0),
                                  Vec3(5.0, 0.0, 2.0),
                                  Vec3(5.0, 0.0, 0.0)}}));
}

/// Cells of a grid in the plane z = 1, as chosen by `mask`, row by row.
Mesh masked_plate(int n, const std::vector<bool>& mask) {
    Mesh plate;
    add_plate(plate, Vec3(0.0, 0.0, 1.0), Vec3(n, 0.0, 0.0), Vec3(0.0, n, 0.0), n, n);
    Mesh mesh{plate.positions, {}};
    for (std::size_t cell = 0; cell < mask.size(); ++cell) {
        if (mask[cell]) {
            mesh.triangles.push_back(plate.triangles[2 * cell]);
            mesh.triangles.push_back(plate.triangles[2 * cell + 1]);
        }
    }
    return mesh;
}

TEST(BorderLoops, RunHolesClockwise) {
    std::vector<bool> mask(25, true);
    mask[12] = false;
    const Facets result = facets_of(masked_plate(5, mask));
    ASSERT_EQ(result.facets.size(), 1U);
    ASSERT_EQ(result.facets[0].loops.size(), 2U);
    EXPECT_EQ(signed_area(result.facets[0].loops[0], Vec3(0.0, 0.0, 1.0)), 25.0);
    EXPECT_EQ(signed_area(result.facets[0].loops[1], Vec3(0.0, 0.0, 1.0)), -1.0);
    EXPECT_EQ(
        result.facets[0].loops[1],
        (Loop{Vec3(2.0, 2.0, 1.0), Vec3(2.0, 3.0, 1.0), Vec3(3.0, 3.0, 1.0), Vec3(3.0, 2.0, 1.0)}));
}

TEST(BorderLoops, KeepCornersOnlyAlsoWhereRoundingBendsStraightRuns) {
    // A notch of 11 x 5 cells in a plate of 17 x 17: eight corners.
    constexpr std::size_t kSide = 17;
    std::vector<bool> mask(kSide * kSide, true);
    for (std::size_t row = 12; row < kSide; ++row) {
        for (std::size_t column = 3; column < 14; ++column) {
            mask[row * kSide + column] = false;
        }
    }
    glm::dmat3 rotation(1.0);
    for (int turn = 0; turn < 20; ++turn) {
        rotation = rotation * some_rotation();
        const Facets result =
            facets_of(as_stored(masked_plate(kSide, mask), rotation, Vec3(4.1, -7.3, 2.9)));
        ASSERT_EQ(result.facets.size(), 1U) << turn;
        ASSERT_EQ(result.facets[0].loops.size(), 1U) << turn;
        EXPECT_EQ(result.facets[0].loops[0].size(), 8U) << turn;
    }
}

/// How often the loop winds about (x, y), by counting crossings of the ray towards +x.
int winding(const Loop& loop, double x, double y) {
    int turns = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3& a = loop[i];
        const Vec3& b = loop[(i + 1) % loop.size()];
        if ((a.y <= y) != (b.y <= y)) {
            const double crossing = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            turns += crossing > x ? (b.y > a.y ? 1 : -1) : 0;
        }
    }
    return turns;
}

TEST(BorderLoops, CoverWithTheirLoopsWhatTheirTrianglesCover) {
    // Random cells of a grid: islands, holes, and borders that touch themselves at corners.
    constexpr int kSide = 9;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE(seed);
        std::vector<bool> mask(kSide * kSide);
        for (std::size_t cell = 0; cell < mask.size(); ++cell) {
            mask[cell] = random(seed, 0, cell) < 0.65;
        }
        const Mesh mesh = masked_plate(kSide, mask);
        const Facets result = facets_of(mesh);
        expect_sound(mesh, result);
        for (const Facet& facet : result.facets) {
            EXPECT_EQ(std::count_if(facet.loops.begin(),
                                    facet.loops.end(),
                                    [&](const Loop& loop) {
                                        return signed_area(loop, facet.plane.normal) > 0.0;
                                    }),
                      1);
        }
        for (const Facet& facet : result.facets) {
            for (const Loop& loop : facet.loops) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const Vec3& b = loop[(i + 1) % loop.size()];
                    const Vec3& c = loop[(i + 2) % loop.size()];
                    EXPECT_NE(glm::cross(b - loop[i], c - b), Vec3(0.0)) << "no corner";
                }
            }
        }
        std::size_t triangle = 0;
        for (std::size_t cell = 0; cell < mask.size(); ++cell) {
            const double x = static_cast<double>(cell % kSide) + 0.5;
            const double y = static_cast<double>(cell / kSide) + 0.5;
            for (FacetId f = 0; f < result.facets.size(); ++f) {
                int turns = 0;
                for (const Loop& loop : result.facets[f].loops) {
                    turns += winding(loop, x, y);
                }
                const bool is_covered = mask[cell] && result.of_triangle[triangle] == f;
                ASSERT_EQ(turns, is_covered ? 1 : 0) << "cell " << cell << " facet " << f;
            }
            triangle += mask[cell] ? 2 : 0;
        }
    }
}

TEST(BorderLoops, LeaveOutSlits) {
    // The same with a wall that crosses half of the floor only: the floor goes round its end.
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), Vec3(0.0, 0.0, 2.0), Vec3(4.0, 0.0, 0.0), 2, 4);
    add_plate(mesh, Vec3(2.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), 1, 1);
    const Facets result = facets_of(mesh);
    ASSERT_EQ(result.facets.size(), 2U);
    EXPECT_EQ(result.facets[0].loops.size(), 1U);
    EXPECT_EQ(result.facets[0].loops[0].size(), 4U);
    expect_sound(mesh, result);
}

TEST(CornersOf, DoesNotDependOnWhereTheLoopBegins) {
    std::vector<Vec3> polygon{Vec3(0.0),
                              Vec3(1.0, 0.0, 0.0),
                              Vec3(2.0, 0.0, 0.0),
                              Vec3(2.0, 2.0, 1.0),
                              Vec3(1.0, 2.0, 1.0),
                              Vec3(0.0, 2.0, 1.0)};
    const Loop want{polygon[0], polygon[2], polygon[3], polygon[5]};
    for (std::size_t turn = 0; turn < polygon.size(); ++turn) {
        EXPECT_EQ(corners_of(polygon, 1e-6), want) << turn;
        std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    }
}

TEST(CornersOf, KeepsThreeCornersOfASliver) {
    const std::vector<Vec3> sliver{
        Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(2.0, 1e-9, 0.0), Vec3(0.5, 1e-8, 0.0)};
    EXPECT_EQ(corners_of(sliver, 1e-6), (Loop{sliver[0], sliver[2], sliver[3]}));
}

}  // namespace
}  // namespace earshot::geometry
