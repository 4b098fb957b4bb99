// SPDX-License-Identifier: MIT
#include "earshot/geometry/clean.h"

#include "earshot/base/random.h"
#include "earshot/geometry/tolerance.h"

#include <gtest/gtest.h>

#include "geometry/made_meshes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace earshot::geometry {
namespace {

TEST(Clean, WeldsACubeOfSeparateSides) {
    const Mesh cube = box_mesh(Vec3(1.0), 1);
    const CleanMesh result = clean(cube.view());
    CleanReport want;
    want.triangles_read = 12;
    want.vertices_read = 24;
    want.vertices_welded = 16;
    EXPECT_EQ(result.report, want);
    EXPECT_EQ(result.kept.size(), 12U);
    for (std::size_t v = 0; v < cube.positions.size(); ++v) {
        EXPECT_LE(result.weld[v], v);
        EXPECT_EQ(cube.positions[result.weld[v]], cube.positions[v]);
        EXPECT_EQ(result.weld[result.weld[v]], result.weld[v]);
    }
}

TEST(Clean, WeldsTheTwoZerosButNoNeighbours) {
    const Mesh mesh{{Vec3(0.0, 1.0, 2.0),
                     Vec3(-0.0, 1.0, 2.0),
                     Vec3(0.0, std::nextafter(1.0, 2.0), 2.0),
                     Vec3(5e-324, 1.0, 2.0)},
                    {}};
    EXPECT_EQ(clean(mesh.view()).weld, (std::vector<VertexId>{0, 0, 2, 3}));
}

TEST(Clean, TakesAnEmptyMesh) {
    const CleanMesh result = clean({});
    EXPECT_EQ(result.report, CleanReport{});
    EXPECT_TRUE(result.kept.empty());
}

TEST(Clean, DropsTrianglesWithoutAreaOnly) {
    const double up = std::nextafter(3.0, 4.0);
    const Mesh mesh{{Vec3(1.0, 1.0, 1.0),
                     Vec3(2.0, 2.0, 2.0),
                     Vec3(3.0, 3.0, 3.0),
                     Vec3(3.0, 3.0, up),
                     Vec3(1.0, 1.0, 1.0),
                     Vec3(0.0, 9.0, 0.0)},
                    {{0, 1, 2},    // on a line
                     {0, 1, 3},    // thinner than any measured area, but not on a line
                     {0, 4, 5},    // two corners at one place
                     {5, 5, 1},    // one corner twice
                     {0, 1, 5}}};  // sound
    const CleanMesh result = clean(mesh.view());
    EXPECT_EQ(result.kept, (std::vector<TriangleId>{1, 4}));
    EXPECT_EQ(result.report.degenerate_triangles, 3U);
}

TEST(Clean, KeepsTheFirstOfTrianglesWithTheSameVertices) {
    const Mesh mesh{{Vec3(0.0, 0.0, 0.0),
                     Vec3(1.0, 0.0, 0.0),
                     Vec3(0.0, 1.0, 0.0),
                     Vec3(1.0, 0.0, 0.0),
                     Vec3(0.0, 0.0, 1.0)},
                    {{1, 2, 0},    // first
                     {0, 1, 4},    // another
                     {0, 2, 3},    // the first, wound the other way, through a welded vertex
                     {2, 0, 1},    // the first again
                     {3, 4, 2}}};  // a third
    const CleanMesh result = clean(mesh.view());
    EXPECT_EQ(result.kept, (std::vector<TriangleId>{0, 1, 4}));
    EXPECT_EQ(result.report.duplicate_triangles, 2U);
    EXPECT_EQ(result.duplicates, (std::vector<DuplicateTriangle>{{2, 0}, {3, 0}}));
    EXPECT_EQ(result.report.vertices_welded, 1U);
}

// Copies of a box that an export has moved in single precision: none of their vertices weld.
TEST(Clean, DropsCopiesWithinTheRoundingOfTheirCoordinates) {
    const Mesh box = box_mesh(Vec3(8.0, 3.5, 6.0), 2);
    const auto count = static_cast<VertexId>(box.positions.size());
    const double tolerance = coplanar_tolerance(box.view());
    for (const double share : {1e-6, 0.1, 0.5}) {
        Mesh doubled = box;
        for (std::size_t i = 0; i < box.positions.size(); ++i) {
            const auto shift = [&](std::uint64_t axis) {
                return share * tolerance * random_between(1, axis, i, -1.0, 1.0);
            };
            doubled.positions.push_back(box.positions[i] + Vec3(shift(0), shift(1), shift(2)));
        }
        for (const Triangle& t : box.triangles) {  // turned over, from another corner on
            doubled.triangles.push_back({t[1] + count, t[0] + count, t[2] + count});
        }
        const CleanMesh result = clean(doubled.view());
        EXPECT_EQ(result.kept.size(), box.triangles.size()) << share;
        EXPECT_EQ(result.report.duplicate_triangles, box.triangles.size()) << share;
        ASSERT_EQ(result.duplicates.size(), box.triangles.size()) << share;
        for (std::size_t i = 0; i < box.triangles.size(); ++i) {
            EXPECT_EQ(result.duplicates[i].duplicate, box.triangles.size() + i);
            EXPECT_EQ(result.duplicates[i].kept, i);
        }
    }
}

TEST(Clean, KeepsNeighboursThatAreSmallerThanTheRounding) {
    // Triangles of a few tolerances, far from the origin: all their corners are close to all
    // others.
    const double size = 3.0 * 1e4 * 0x1p-21;
    Mesh mesh;
    add_plate(mesh, Vec3(1e4), Vec3(size, 0.0, 0.0), Vec3(0.0, size, 0.0), 3, 3);
    EXPECT_EQ(clean(mesh.view()).report.duplicate_triangles, 0U);
    // And a copy that is farther than the tolerance is another surface.
    Mesh box = box_mesh(Vec3(8.0), 1);
    const auto count = static_cast<VertexId>(box.positions.size());
    const double gap = 1.1 * coplanar_tolerance(box.view());
    for (VertexId v = 0; v < count; ++v) {
        box.positions.push_back(box.positions[v] - Vec3(gap, 0.0, 0.0));
    }
    const std::vector<Triangle> triangles = box.triangles;
    for (const Triangle& t : triangles) {
        box.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    }
    EXPECT_EQ(clean(box.view()).report.duplicate_triangles, 0U);
}

TEST(Clean, CountsHolesByTheirConnectedEdges) {
    Mesh box = box_mesh(Vec3(3.0), 3);
    EXPECT_EQ(clean(box.view()).report.holes, 0U);
    // The middle cells of the first two sides.
    for (const std::ptrdiff_t cell : {9 + 4, 4}) {
        const auto begin = box.triangles.begin() + 2 * cell;
        box.triangles.erase(begin, begin + 2);
    }
    const CleanReport report = clean(box.view()).report;
    EXPECT_EQ(report.open_edges, 8U);
    EXPECT_EQ(report.holes, 2U);
    EXPECT_EQ(report.non_manifold_edges, 0U);
    EXPECT_EQ(report.t_junctions, 0U);
}

TEST(Clean, CountsEdgesWithMoreThanTwoTriangles) {
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), Vec3(2.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), 2, 1);
    add_plate(mesh, Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0), 1, 1);
    const CleanReport report = clean(mesh.view()).report;
    EXPECT_EQ(report.non_manifold_edges, 1U);
    EXPECT_EQ(report.open_edges, 6U + 3U);
    EXPECT_EQ(report.holes, 1U);  // the two borders meet in the ends of the shared edge
}

TEST(Clean, CountsVerticesInsideOpenEdges) {
    // One plate beside two and beside three smaller ones: 1 + 2 vertices inside its long edges.
    Mesh mesh;
    const Vec3 y(0.0, 0.6, 0.0);
    add_plate(mesh, Vec3(0.0), Vec3(1.0, 0.0, 0.0), y, 1, 1);
    add_plate(mesh, Vec3(1.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), y, 1, 2);
    add_plate(mesh, Vec3(-1.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), y, 1, 3);
    EXPECT_EQ(clean(mesh.view()).report.t_junctions, 3U);
    // Turned and stored as floats the vertices are only near the edges.
    const glm::dmat3 turn(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6);
    EXPECT_EQ(clean(as_stored(mesh, turn, Vec3(5.1, -3.3, 0.7)).view()).report.t_junctions, 3U);
    // A gap that can be seen is no T-junction.
    const double gap = 3.0 * coplanar_tolerance(mesh.view());
    for (std::size_t v = 4; v < mesh.positions.size(); ++v) {
        mesh.positions[v].z += gap;
    }
    EXPECT_EQ(clean(mesh.view()).report.t_junctions, 0U);
}

TEST(Clean, TakesAVertexBesideACornerForACornerThatDidNotWeld) {
    const Mesh plate{{Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0)}, {{0, 1, 2}}};
    const double near = 0.5 * coplanar_tolerance(plate.view());
    for (const double step : {near, 4.0 * near}) {
        Mesh mesh = plate;
        mesh.positions.insert(mesh.positions.end(),
                              {Vec3(step, 0.0, 0.0), Vec3(0.0, -1.0, 0.0), Vec3(1.0, -1.0, 0.0)});
        mesh.triangles.push_back({3, 4, 5});
        EXPECT_EQ(clean(mesh.view()).report.t_junctions, step > near ? 1U : 0U);
    }
}

// Everything again by exhaustive search over small meshes with many coincidences.
struct Soup {
    Mesh mesh;
    std::vector<Triangle> welded;  // those with area, first ones only
    std::size_t degenerate = 0;
};

Soup make_soup(std::uint64_t seed) {
    Soup soup;
    constexpr std::uint64_t kVertices = 40;
    for (std::uint64_t v = 0; v < kVertices; ++v) {
        soup.mesh.positions.emplace_back(static_cast<double>(random_bits(seed, 0, v) % 4),
                                         static_cast<double>(random_bits(seed, 1, v) % 3),
                                         static_cast<double>(random_bits(seed, 2, v) % 2));
    }
    std::map<std::array<double, 3>, VertexId> places;
    std::vector<VertexId> weld;
    for (const Vec3& p : soup.mesh.positions) {
        weld.push_back(
            places.try_emplace({p.x, p.y, p.z}, static_cast<VertexId>(weld.size())).first->second);
    }
    std::set<std::set<VertexId>> known;
    for (std::uint64_t t = 0; t < 40; ++t) {
        Triangle triangle{};
        for (std::uint64_t k = 0; k < 3; ++k) {
            triangle[k] = static_cast<VertexId>(random_bits(seed, 3 + k, t) % kVertices);
        }
        soup.mesh.triangles.push_back(triangle);
        const auto& p = soup.mesh.positions;
        // Small whole numbers: the cross product is exact.
        const Vec3 normal =
            glm::cross(p[triangle[1]] - p[triangle[0]], p[triangle[2]] - p[triangle[0]]);
        const Triangle welded{weld[triangle[0]], weld[triangle[1]], weld[triangle[2]]};
        if (normal == Vec3(0.0)) {
            ++soup.degenerate;
        } else if (known.insert({welded.begin(), welded.end()}).second) {
            soup.welded.push_back(welded);
        }
    }
    return soup;
}

TEST(Clean, AgreesWithExhaustiveSearchOnRandomSoups) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE(seed);
        const Soup soup = make_soup(seed);
        const auto& p = soup.mesh.positions;
        std::map<std::set<VertexId>, int> edges;
        for (const auto& [a, b, c] : soup.welded) {
            ++edges[{a, b}];
            ++edges[{b, c}];
            ++edges[{c, a}];
        }
        std::vector<std::set<VertexId>> open;
        std::set<VertexId> ends;
        std::size_t non_manifold = 0;
        for (const auto& [edge, uses] : edges) {
            non_manifold += uses > 2 ? 1U : 0U;
            if (uses == 1) {
                open.push_back(edge);
                ends.insert(edge.begin(), edge.end());
            }
        }
        std::size_t junctions = 0;
        for (const VertexId v : ends) {
            // Whole numbers: on the segment exactly or not near it.
            junctions += std::any_of(open.begin(), open.end(), [&](const std::set<VertexId>& edge) {
                const Vec3 from = p[*edge.begin()] - p[v];
                const Vec3 to = p[*edge.rbegin()] - p[v];
                return glm::cross(from, to) == Vec3(0.0) && glm::dot(from, to) < 0.0;
            });
        }
        // Merge open edges that share a vertex until none does.
        std::vector<std::set<VertexId>> groups = open;
        for (std::size_t i = 0; i < groups.size(); ++i) {
            for (std::size_t j = i + 1; j < groups.size();) {
                std::set<VertexId> both = groups[i];
                both.insert(groups[j].begin(), groups[j].end());
                if (both.size() == groups[i].size() + groups[j].size()) {
                    ++j;
                    continue;
                }
                groups[i] = both;
                groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(j));
                j = i + 1;
            }
        }
        const CleanMesh result = clean(soup.mesh.view());
        EXPECT_EQ(result.report.degenerate_triangles, soup.degenerate);
        EXPECT_EQ(result.kept.size(), soup.welded.size());
        EXPECT_EQ(result.report.open_edges, open.size());
        EXPECT_EQ(result.report.non_manifold_edges, non_manifold);
        EXPECT_EQ(result.report.t_junctions, junctions);
        EXPECT_EQ(result.report.holes, groups.size());
    }
}

TEST(Clean, FindsNothingMoreInWhatItKept) {
    constexpr std::uint64_t kSeed = 77;
    Mesh mesh;
    for (std::uint64_t v = 0; v < 6000; ++v) {
        // Around 20 clusters of very different size, on a lattice so that some coincide.
        const double scale = std::ldexp(1.0, -static_cast<int>(random_bits(kSeed, 0, v) % 20));
        const auto cell = [&](std::uint64_t s) {
            return static_cast<double>(random_bits(kSeed, s, v) % 16);
        };
        mesh.positions.push_back(Vec3(cell(1), cell(2), cell(3)) * scale);
    }
    for (std::uint64_t t = 0; t < 8000; ++t) {
        const auto corner = [&](std::uint64_t s) {
            return static_cast<VertexId>(random_bits(kSeed, s, t) % mesh.positions.size());
        };
        mesh.triangles.push_back({corner(4), corner(5), corner(6)});
    }
    const CleanMesh first = clean(mesh.view());
    EXPECT_TRUE(std::is_sorted(first.kept.begin(), first.kept.end()));
    EXPECT_EQ(
        first.kept.size() + first.report.degenerate_triangles + first.report.duplicate_triangles,
        mesh.triangles.size());
    Mesh kept{mesh.positions, {}};
    for (const TriangleId t : first.kept) {
        kept.triangles.push_back(mesh.triangles[t]);
    }
    const CleanReport second = clean(kept.view()).report;
    EXPECT_EQ(second.degenerate_triangles, 0U);
    EXPECT_EQ(second.duplicate_triangles, 0U);
    EXPECT_EQ(second.open_edges, first.report.open_edges);
    EXPECT_EQ(second.t_junctions, first.report.t_junctions);
    EXPECT_GT(second.t_junctions, 0U);
}

TEST(Clean, CountsTheSameInAnyOrderOfTriangles) {
    std::vector<TriangleId> order;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Soup soup = make_soup(seed);
        const Mesh other = shuffled(soup.mesh, seed, order);
        EXPECT_EQ(clean(other.view()).report, clean(soup.mesh.view()).report) << seed;
    }
}

}  // namespace
}  // namespace earshot::geometry
