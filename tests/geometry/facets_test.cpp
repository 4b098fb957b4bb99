// SPDX-License-Identifier: MIT
#include "earshot/geometry/facets.h"

#include "earshot/base/random.h"
#include "earshot/geometry/clean.h"

#include <gtest/gtest.h>

#include "geometry/facet_checks.h"
#include "geometry/made_meshes.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace earshot::geometry {
namespace {

using Shape = std::tuple<double, double, double, double, std::vector<std::vector<double>>>;

/// Planes and loops as values that compare by bits (but for zeros), in an order of their own.
std::vector<Shape> shapes_of(const Facets& result) {
    std::vector<Shape> shapes;
    for (const Facet& facet : result.facets) {
        std::vector<std::vector<double>> loops;
        for (const Loop& loop : facet.loops) {
            loops.emplace_back();
            for (const Vec3& p : loop) {
                loops.back().insert(loops.back().end(), {p.x, p.y, p.z});
            }
        }
        const Vec3& n = facet.plane.normal;
        shapes.emplace_back(n.x, n.y, n.z, facet.plane.offset, loops);
    }
    std::sort(shapes.begin(), shapes.end());
    return shapes;
}

TEST(Facets, OfABoxAreExactHoweverItIsCut) {
    const Vec3 size(7.0, 3.5, 11.25);
    const Facets coarse = facets_of(box_mesh(size, 1));
    ASSERT_EQ(coarse.facets.size(), 6U);
    const Facet& floor =
        *std::find_if(coarse.facets.begin(), coarse.facets.end(), [](const Facet& f) {
            return f.plane.normal == Vec3(0.0, -1.0, 0.0);
        });
    EXPECT_EQ(floor.plane.offset, -3.5);
    EXPECT_EQ(floor.loops,
              (std::vector<Loop>{{Vec3(0.0, 3.5, 0.0),
                                  Vec3(7.0, 3.5, 0.0),
                                  Vec3(7.0, 3.5, 11.25),
                                  Vec3(0.0, 3.5, 11.25)}}));
    for (const int n : {2, 4, 16}) {  // 16: 3,072 triangles
        const Mesh mesh = box_mesh(size, n);
        const Facets fine = facets_of(mesh);
        expect_sound(mesh, fine);
        EXPECT_EQ(shapes_of(fine), shapes_of(coarse)) << n;
        for (const Facet& facet : fine.facets) {
            EXPECT_EQ(facet.deviation, 0.0);
        }
    }
}

TEST(Facets, OfABoxCutIntoUnevenTrianglesAreExactToo) {
    // 10 / 3 and such are no doubles: vertices within a side are rounded, but not out of its plane.
    const Vec3 size(10.0, 3.3, 4.7);
    const Facets coarse = facets_of(box_mesh(size, 1));
    for (const int n : {3, 7, 15}) {
        EXPECT_EQ(shapes_of(facets_of(box_mesh(size, n))), shapes_of(coarse)) << n;
    }
}

TEST(Facets, OfATurnedBoxOfFloatsAreItsSixSides) {
    for (const int n : {1, 3, 16}) {
        for (int turn = 0; turn < 4; ++turn) {
            SCOPED_TRACE(n * 10 + turn);
            glm::dmat3 rotation(1.0);
            for (int i = 0; i < turn; ++i) {
                rotation = rotation * some_rotation();
            }
            const Mesh mesh =
                as_stored(box_mesh(Vec3(9.0, 4.0, 6.0), n), rotation, Vec3(3.3, -8.1, 14.7));
            const Facets result = facets_of(mesh);
            ASSERT_EQ(result.facets.size(), 6U);
            expect_sound(mesh, result);
            for (const Facet& facet : result.facets) {
                EXPECT_EQ(facet.loops.size(), 1U);
                EXPECT_EQ(facet.loops.front().size(), 4U);
                EXPECT_NEAR(glm::length(facet.plane.normal), 1.0, 4e-16);
            }
        }
    }
}

TEST(Facets, EndWhereTheLabelChanges) {
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), Vec3(4.0, 0.0, 0.0), Vec3(0.0, 2.0, 0.0), 4, 1);
    const Facets result = facets_of(mesh, {5, 5, 5, 5, 2, 2, 5, 5});
    ASSERT_EQ(result.facets.size(), 3U);
    EXPECT_EQ(result.of_triangle, (std::vector<FacetId>{0, 0, 0, 0, 1, 1, 2, 2}));
    expect_sound(mesh, result);
}

TEST(Facets, EndWhereAWallStandsOnTheFloor) {
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), Vec3(0.0, 0.0, 2.0), Vec3(4.0, 0.0, 0.0), 2, 4);
    add_plate(mesh, Vec3(2.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 2.0), 1, 2);
    EXPECT_EQ(facets_of(mesh).facets.size(), 3U);
}

TEST(Facets, DoNotTakeInATriangleThatFoldsBack) {
    const Mesh mesh{{Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.5, 1.0, 0.0), Vec3(0.4, 0.5, 0.0)},
                    {{0, 1, 2}, {1, 0, 3}}};
    EXPECT_EQ(facets_of(mesh).facets.size(), 2U);
}

TEST(Facets, TakeInSliversWhoseNormalIsNoise) {
    // Two halves of a floor with a sliver between them, one corner of it a float's step too high
    // and a step to either side: the sliver looks up or down.
    constexpr double kStep = 0x1p-22;
    for (const double side : {kStep, -kStep}) {
        const Mesh mesh{{Vec3(0.0, 0.0, 0.0),
                         Vec3(2.0, 0.0, 0.0),
                         Vec3(2.0, 2.0, 0.0),
                         Vec3(0.0, 2.0, 0.0),
                         Vec3(1.0, 1.0 + side, kStep)},
                        {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}}};
        const Facets result = facets_of(mesh);
        EXPECT_EQ(result.facets.size(), 1U);
        expect_sound(mesh, result);
    }
}

TEST(Facets, DoNotDriftAlongACurve) {
    // Strips of a cylinder; from each to the next the surface leaves the plane by less than the
    // tolerance, after a few it is well off.
    Mesh mesh;
    constexpr int kStrips = 1000;
    constexpr double kAngle = 0.05e-3;
    const auto rim = [](int i, double z) {
        return Vec3(10.0 * std::sin(kAngle * i), 10.0 * std::cos(kAngle * i), z);
    };
    for (int i = 0; i < kStrips; ++i) {
        const auto first = static_cast<VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(),
                              {rim(i, 0.0), rim(i + 1, 0.0), rim(i + 1, 1.0), rim(i, 1.0)});
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    const Facets result = facets_of(mesh);
    expect_sound(mesh, result);
    EXPECT_GT(result.facets.size(), 10U);
    for (const Facet& facet : result.facets) {
        EXPECT_LE(facet.deviation, 4.0 * result.tolerance);
    }
}

TEST(Facets, KeepSmallReliefApart) {
    // A step of 0.06 mm, four metres from the largest triangles, whose rounding could tilt their
    // plane that much: the step is still too steep for its size.
    Mesh mesh;
    constexpr double kStep = 6e-5;
    const Vec3 y(0.0, 0.5, 0.0);
    add_plate(mesh, Vec3(-0.5, 0.0, 0.0), Vec3(0.5, 0.0, 0.0), y, 1, 5);
    add_plate(mesh, Vec3(0.0), Vec3(4.0, 0.0, 0.0), y, 40, 5);
    add_plate(mesh, Vec3(4.0, 0.0, 0.0), Vec3(0.0, 0.0, kStep), y, 1, 5);
    add_plate(mesh, Vec3(4.0, 0.0, kStep), Vec3(4.0, 0.0, 0.0), y, 40, 5);
    const Facets result = facets_of(mesh);
    EXPECT_EQ(result.facets.size(), 3U);
    expect_sound(mesh, result);
}

TEST(Facets, OfAFineSphereAreItsTriangles) {
    Mesh mesh;
    constexpr int kRows = 24;
    constexpr int kColumns = 48;
    const double pi = std::acos(-1.0);
    const auto at = [&](int i, int j) {
        const double a = pi * i / kRows;
        const double b = 2.0 * pi * (j % kColumns) / kColumns;
        return Vec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
    };
    for (int i = 0; i < kRows; ++i) {
        for (int j = 0; j < kColumns; ++j) {
            const auto first = static_cast<VertexId>(mesh.positions.size());
            mesh.positions.insert(mesh.positions.end(),
                                  {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
            if (i > 0) {
                mesh.triangles.push_back({first, first + 1, first + 2});
            }
            if (i + 1 < kRows) {
                mesh.triangles.push_back({first, first + 2, first + 3});
            }
        }
    }
    // Cells are planar trapezoids, caps are triangles.
    const Facets result = facets_of(mesh);
    expect_sound(mesh, result);
    EXPECT_EQ(result.facets.size(), static_cast<std::size_t>(kRows * kColumns));
}

TEST(Facets, DoNotDependOnTheOrderOfTriangles) {
    Mesh mesh = box_mesh(Vec3(8.0, 4.0, 2.0), 4);
    add_plate(mesh, Vec3(1.0, 1.0, 1.0), Vec3(1.0, 0.0, 1.0), Vec3(0.0, 1.0, 0.0), 3, 3);
    const Facets original = facets_of(mesh);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        std::vector<TriangleId> order;
        const Mesh other = shuffled(mesh, seed, order);
        const Facets result = facets_of(other);
        EXPECT_EQ(shapes_of(result), shapes_of(original));
        std::set<std::set<TriangleId>> want;
        std::set<std::set<TriangleId>> got;
        for (const Facet& facet : original.facets) {
            want.emplace(facet.triangles.begin(), facet.triangles.end());
        }
        for (const Facet& facet : result.facets) {
            std::set<TriangleId> members;
            for (const TriangleId t : facet.triangles) {
                members.insert(order[t]);
            }
            got.insert(members);
        }
        EXPECT_EQ(got, want);
    }
}

TEST(Facets, HaveAPlaneEvenWhereRoundingLeavesNoArea) {
    // Not on a line, but the differences of the coordinates are.
    const Mesh mesh{{Vec3(0x1p-60, 0.0, 0.0), Vec3(1.0), Vec3(2.0)}, {{0, 1, 2}}};
    const Facets result = facets_of(mesh);
    ASSERT_EQ(result.facets.size(), 1U);
    EXPECT_NEAR(glm::length(result.facets[0].plane.normal), 1.0, 4e-16);
    EXPECT_LE(result.facets[0].deviation, result.tolerance);
}

TEST(Facets, OfNothingAreNone) {
    EXPECT_TRUE(find_facets({}, {}, {}).facets.empty());
}

TEST(FacetFinder, FollowsADeformingMeshAsIfEachPoseWereTheFirst) {
    Mesh mesh = box_mesh(Vec3(4.0, 2.0, 3.0), 6);
    const std::vector<VertexId> weld = clean(mesh.view()).weld;
    std::vector<std::uint32_t> labels(mesh.triangles.size(), 0);
    std::fill(labels.begin(), labels.begin() + 40, 1);
    const FacetFinder finder(mesh.view(), weld, labels);
    Executor two(2), eight(8);
    std::set<std::size_t> counts;
    for (int frame = 0; frame < 8; ++frame) {
        Mesh moved = mesh;
        for (Vec3& position : moved.positions) {
            // A wall that bulges, more from frame to frame, and lies flat again in every third.
            const double depth = position.x > 3.9 && frame % 3 != 0 ? 0.02 * frame : 0.0;
            position.x += depth * position.y * (2.0 - position.y) * position.z;
        }
        const Facets expected = find_facets(moved.view(), weld, labels);
        for (Executor* executor : {&two, &eight, &Executor::serial()}) {
            const Facets found = finder.find(moved.view(), *executor);
            ASSERT_EQ(found.of_triangle, expected.of_triangle) << frame;
            ASSERT_EQ(found.tolerance, expected.tolerance);
            for (std::size_t i = 0; i < expected.facets.size(); ++i) {
                EXPECT_EQ(found.facets[i].plane.normal, expected.facets[i].plane.normal);
                EXPECT_EQ(found.facets[i].plane.offset, expected.facets[i].plane.offset);
                EXPECT_EQ(found.facets[i].deviation, expected.facets[i].deviation);
                EXPECT_EQ(found.facets[i].triangles, expected.facets[i].triangles);
                EXPECT_EQ(found.facets[i].loops, expected.facets[i].loops);
            }
        }
        counts.insert(expected.facets.size());
    }
    EXPECT_GT(counts.size(), 1U);
}

TEST(Plane, MirrorsExactlyAcrossCoordinatePlanes) {
    const Plane wall{Vec3(-1.0, 0.0, 0.0), -7.3};  // x = 7.3, seen from smaller x
    EXPECT_EQ(wall.distance(Vec3(7.3, 5.0, 1.0)), 0.0);
    EXPECT_EQ(wall.distance(Vec3(7.0, 5.0, 1.0)), 7.3 - 7.0);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const double x = random_between(6, 0, i, -20.0, 20.0);
        EXPECT_EQ(wall.mirror(Vec3(x, 0.1, -0.3)), Vec3(2.0 * 7.3 - x, 0.1, -0.3)) << i;
    }
}

TEST(Plane, MirrorsAnyPointToTheSameDistanceBehind) {
    const Vec3 normal = glm::normalize(Vec3(1.0, -2.0, 0.5));
    const Plane plane{normal, 0.7};
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const Vec3 p(random_between(6, 1, i, -20.0, 20.0),
                     random_between(6, 2, i, -20.0, 20.0),
                     random_between(6, 3, i, -20.0, 20.0));
        const Vec3 image = plane.mirror(p);
        // A dozen roundings at coordinates below 64.
        constexpr double kRounding = 12.0 * 64.0 * 0x1p-53;
        EXPECT_NEAR(plane.distance(image), -plane.distance(p), kRounding) << i;
        EXPECT_NEAR(glm::length(glm::cross(image - p, normal)), 0.0, kRounding) << i;
    }
}

Mesh read_obj(const std::filesystem::path& path) {
    Mesh mesh;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            Vec3 p(0.0);
            words >> p.x >> p.y >> p.z;
            mesh.positions.push_back(p);
        } else if (kind == "f") {
            Triangle triangle{};
            for (VertexId& vertex : triangle) {
                std::string corner;
                words >> corner;
                vertex = static_cast<VertexId>(std::stoul(corner)) - 1;
            }
            mesh.triangles.push_back(triangle);
        }
    }
    return mesh;
}

TEST(Facets, OfTheBunnyHaveItsArea) {
    const std::filesystem::path path = test::shared_file("models") / "stanford-bunny.obj";
    if (!std::filesystem::exists(path)) {
        GTEST_SKIP() << "third-party mesh absent: " << path;
    }
    Mesh mesh = read_obj(path);
    const CleanMesh cleaned = clean(mesh.view());
    Mesh kept{mesh.positions, {}};
    for (const TriangleId t : cleaned.kept) {
        kept.triangles.push_back(mesh.triangles[t]);
    }
    const Facets result = facets_of(kept);
    expect_sound(kept, result);
    double by_loops = 0.0;
    double by_triangles = 0.0;
    for (const Facet& facet : result.facets) {
        for (const Loop& loop : facet.loops) {
            by_loops += signed_area(loop, facet.plane.normal);
        }
        by_triangles += area_of(kept, facet.triangles);
    }
    // Curved all over: nearly every triangle is a facet.
    EXPECT_GT(result.facets.size(), kept.triangles.size() / 2);
    EXPECT_NEAR(by_loops, by_triangles, 1e-4 * by_triangles);
}

}  // namespace
}  // namespace earshot::geometry
