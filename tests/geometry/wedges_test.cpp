// SPDX-License-Identifier: MIT
#include "earshot/geometry/wedges.h"

#include "earshot/base/math.h"
#include "earshot/geometry/vector.h"

#include <gtest/gtest.h>

#include "geometry/facet_checks.h"
#include "support/dice.h"
#include "support/random_rooms.h"
#include "support/rooms.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::geometry {
namespace {

using support::Facing;
using support::Room;

constexpr double kDegrees = 180.0 / math::kPi;

/// The facets of a room from which clean-up has taken what it drops.
Facets facets_of_room(const Room& room) {
    Mesh mesh = room.mesh;
    const CleanMesh cleaned = clean(mesh.view());
    std::vector<Triangle> kept;
    std::vector<std::uint32_t> labels;
    for (const TriangleId t : cleaned.kept) {
        kept.push_back(mesh.triangles[t]);
        labels.push_back(room.labels[t]);
    }
    mesh.triangles = kept;
    return find_facets(mesh.view(), cleaned.weld, labels);
}

/// Walls face the air: their backs are not heard. Sheets are heard from both sides.
std::vector<Wedge> wedges_of(const Room& room) {
    const Facets facets = facets_of_room(room);
    std::vector<std::uint8_t> one_sided;
    for (const Facet& facet : facets.facets) {
        one_sided.push_back(room.is_sheet[facet.triangles.front()] != 0 ? 0 : 1);
    }
    return find_wedges(facets, {.one_sided = one_sided, .transmissive = {}});
}

std::vector<double> angles_of(const std::vector<Wedge>& wedges) {
    std::vector<double> angles;
    for (const Wedge& wedge : wedges) {
        angles.push_back(wedge.open_angle * kDegrees);
    }
    std::sort(angles.begin(), angles.end());
    return angles;
}

void expect_angles(const std::vector<Wedge>& wedges, const std::vector<double>& expected) {
    const std::vector<double> found = angles_of(wedges);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i], expected[i], 1e-6);
    }
}

void expect_sound_frame(const Wedge& wedge, const Facets& facets) {
    EXPECT_NEAR(glm::length(wedge.direction), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(wedge.direction, wedge.tangent), 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(glm::cross(wedge.direction, wedge.tangent), wedge.normal), 0, 1e-12);
    const Plane& plane = facets.facets[wedge.faces[0].facet].plane;
    EXPECT_NEAR(glm::dot(plane.normal, wedge.normal), wedge.faces[0].is_front ? 1.0 : -1.0, 1e-6);
    EXPECT_NEAR(plane.distance(wedge.begin + wedge.tangent), 0.0, 1e-5);
}

Room room_with_box(const Vec3& lower, const Vec3& upper) {
    Room room = support::box_room({0, 0, 0}, {5, 3, 4});
    support::add_hexahedron(room, support::box_corners(lower, upper), Facing::outward, 10);
    return room;
}

TEST(Wedges, BoxRoomHasNone) {
    EXPECT_TRUE(wedges_of(support::box_room({0, 0, 0}, {5, 3, 4})).empty());
}

TEST(Wedges, LRoomHasTheEdgeOfItsCorner) {
    const auto wedges = wedges_of(support::reference_l_room());
    expect_angles(wedges, {270.0});
    EXPECT_DOUBLE_EQ(wedges[0].length(), 3.0);
    EXPECT_EQ(std::abs(wedges[0].direction.y), 1.0);
}

TEST(Wedges, FloatingBoxHasTwelveAndItsInsideNone) {
    expect_angles(wedges_of(room_with_box({1, 1, 1}, {2, 2, 2})), std::vector<double>(12, 270.0));
}

TEST(Wedges, StandingBoxHasNoneAtItsFoot) {
    const auto wedges = wedges_of(room_with_box({1, 0, 1}, {2, 1.5, 2}));
    expect_angles(wedges, std::vector<double>(8, 270.0));
    for (const Wedge& wedge : wedges) {
        EXPECT_GT(std::max(wedge.begin.y, wedge.end.y), 1.0);
    }
}

Room sheet_in_room(const std::array<Vec3, 4>& corners) {
    Room room = support::box_room({0, 0, 0}, {5, 3, 4});
    support::add_polygon(room, corners, 20, true);
    return room;
}

TEST(Wedges, PlateHasItsBorder) {
    const Room room = sheet_in_room({Vec3(1, 1, 2), Vec3(2, 1, 2), Vec3(2, 2, 2), Vec3(1, 2, 2)});
    const auto wedges = wedges_of(room);
    expect_angles(wedges, std::vector<double>(4, 360.0));
    for (const Wedge& wedge : wedges) {
        EXPECT_EQ(wedge.open_angle, 2.0 * math::kPi);
        EXPECT_EQ(wedge.faces[0].facet, wedge.faces[1].facet);
        EXPECT_NE(wedge.faces[0].is_front, wedge.faces[1].is_front);
    }
}

// It runs from one wall into the middle of the room and stands on the floor.
TEST(Wedges, PartitionHasItsFreeBordersOnly) {
    const Room room = sheet_in_room({Vec3(0, 0, 2), Vec3(3, 0, 2), Vec3(3, 2, 2), Vec3(0, 2, 2)});
    const auto wedges = wedges_of(room);
    expect_angles(wedges, {360.0, 360.0});
    const double sum = wedges[0].length() + wedges[1].length();
    EXPECT_DOUBLE_EQ(sum, 5.0);
}

// Half of its foot stands on a podium, the other half floats beside it.
TEST(Wedges, FootThatLeavesAFloorIsAnEdgeFromThereOn) {
    Room room = room_with_box({1, 0, 1}, {2, 1, 3});
    support::add_polygon(
        room, std::array{Vec3(1.5, 1, 2), Vec3(3, 1, 2), Vec3(3, 2, 2), Vec3(1.5, 2, 2)}, 20, true);
    const auto wedges = wedges_of(room);
    std::vector<double> lengths;
    for (const Wedge& wedge : wedges) {
        if (wedge.open_angle > 6.0) {
            lengths.push_back(wedge.length());
        }
    }
    std::sort(lengths.begin(), lengths.end());
    ASSERT_EQ(lengths.size(), 4U);
    EXPECT_DOUBLE_EQ(lengths[0], 1.0);  // the foot beside the podium and both sides
    EXPECT_DOUBLE_EQ(lengths[2], 1.0);
    EXPECT_DOUBLE_EQ(lengths[3], 1.5);
}

TEST(Wedges, InnerCornersCountUnlessTheyDivideAHalfTurn) {
    std::vector<glm::dvec2> hexagon;
    for (int i = 0; i < 6; ++i) {
        hexagon.emplace_back(2.0 * std::cos(i / 3.0 * math::kPi),
                             2.0 * std::sin(i / 3.0 * math::kPi));
    }
    expect_angles(wedges_of(support::plan_room(hexagon, 3.0)), std::vector<double>(6, 120.0));
    const std::vector<glm::dvec2> triangle{{0, 0}, {2, 0}, {1, std::sqrt(3.0)}};
    EXPECT_TRUE(wedges_of(support::plan_room(triangle, 3.0)).empty());
}

TEST(Wedges, ThreeSheetsOnALineMakeThreeSectors) {
    Room room;
    for (const double angle : {0.0, 100.0, 250.0}) {
        const Vec3 out(std::cos(angle / kDegrees), std::sin(angle / kDegrees), 0.0);
        const Vec3 top(0, 0, 1);
        support::add_polygon(room, std::array{Vec3(0.0), out, out + top, top}, 0, true);
    }
    std::vector<double> middle;
    for (const Wedge& wedge : wedges_of(room)) {
        if (wedge.open_angle < 6.0) {
            middle.push_back(wedge.open_angle * kDegrees);
        }
    }
    std::sort(middle.begin(), middle.end());
    ASSERT_EQ(middle.size(), 3U);
    EXPECT_NEAR(middle[0], 100.0, 1e-3);
    EXPECT_NEAR(middle[1], 110.0, 1e-3);
    EXPECT_NEAR(middle[2], 150.0, 1e-3);
}

// A door between walls: the wedge at its hinge follows it, with the faces that it had.
TEST(Wedges, FollowAHinge) {
    for (int degrees = 5; degrees < 180; degrees += 10) {
        const double angle = degrees / kDegrees;
        Room room;
        const Vec3 top(0, 0, 2);
        const Vec3 door(-std::cos(angle), std::sin(angle), 0.0);
        support::add_polygon(
            room, std::array{Vec3(0.0), Vec3(3, 0, 0), Vec3(3, 0, 2), top}, 0, true);
        support::add_polygon(room, std::array{Vec3(0.0), door, door + top, top}, 0, true);
        std::vector<double> at_hinge;
        for (const Wedge& wedge : wedges_of(room)) {
            if (wedge.open_angle != 2.0 * math::kPi) {
                EXPECT_EQ(glm::length(glm::cross(wedge.begin, Vec3(0, 0, 1))), 0.0);
                EXPECT_DOUBLE_EQ(wedge.length(), 2.0);
                at_hinge.push_back(wedge.open_angle * kDegrees);
            }
        }
        std::sort(at_hinge.begin(), at_hinge.end());
        // A corner of pi / n between the wall and the door is none.
        const double inside = 180.0 - degrees;
        const bool is_corner = std::abs(std::sin(math::kPi * 180.0 / inside)) < kMinWedgeSine;
        ASSERT_EQ(at_hinge.size(), is_corner ? 1U : 2U) << degrees;
        EXPECT_NEAR(at_hinge.front(), is_corner ? 180.0 + degrees : inside, 1e-4);
        EXPECT_NEAR(at_hinge.back(), 180.0 + degrees, 1e-4);
    }
}

TEST(Wedges, TransmissiveAndOneSidedFacets) {
    const Room room = sheet_in_room({Vec3(1, 1, 2), Vec3(2, 1, 2), Vec3(2, 2, 2), Vec3(1, 2, 2)});
    const Facets facets = facets_of_room(room);
    const std::vector<std::uint8_t> all(facets.facets.size(), 1);
    std::vector<std::uint8_t> sheet(facets.facets.size(), 0);
    sheet.back() = 1;
    EXPECT_EQ(find_wedges(facets).size(), 16U);  // with the outside of the room
    EXPECT_EQ(find_wedges(facets, {.one_sided = {}, .transmissive = sheet}).size(), 12U);
    EXPECT_EQ(find_wedges(facets, {.one_sided = sheet, .transmissive = {}}).size(), 12U);
    EXPECT_TRUE(find_wedges(facets, {.one_sided = all, .transmissive = {}}).empty());
}

TEST(Wedges, DoNotDependOnHowWallsAreCut) {
    const auto plain = wedges_of(room_with_box({1, 0, 1}, {2, 1.5, 2}));
    Room cut = support::tessellated_box_room({0, 0, 0}, {5, 3, 4}, 4);
    const Room pillar = support::tessellated_box_room({1, 0, 1}, {2, 1.5, 2}, 3);
    for (Triangle triangle : pillar.mesh.triangles) {
        std::swap(triangle[0], triangle[1]);
        const auto [a, b, c] = corners(pillar.mesh.positions, triangle);
        support::add_triangle(cut, {a, b, c}, 10);
    }
    const auto fine = wedges_of(cut);
    ASSERT_EQ(fine.size(), plain.size());
    const auto key = [](const Wedge& wedge) {
        return std::array{wedge.begin.x,
                          wedge.begin.y,
                          wedge.begin.z,
                          wedge.end.x,
                          wedge.end.y,
                          wedge.end.z,
                          wedge.open_angle};
    };
    std::vector<std::array<double, 7>> a, b;
    for (std::size_t i = 0; i < plain.size(); ++i) {
        a.push_back(key(plain[i]));
        b.push_back(key(fine[i]));
    }
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    EXPECT_EQ(a, b);
}

double distance_to_segment(const Vec3& point, const Vec3& from, const Vec3& to) {
    const Vec3 way = to - from;
    const double t = std::clamp(glm::dot(point - from, way) / glm::dot(way, way), 0.0, 1.0);
    return glm::distance(point, from + t * way);
}

/// The sectors of air about a point of a line, by the triangles that a small circle across the line
/// meets. Nothing if other surfaces are too close to tell.
std::optional<std::vector<double>> sectors_about(const Mesh& mesh,
                                                 const Vec3& point,
                                                 const Vec3& direction) {
    constexpr double kRadius = 5e-5;
    const Vec3 e1 = normalized(
        glm::cross(direction, std::abs(direction.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
    const Vec3 e2 = glm::cross(direction, e1);
    std::vector<double> angles;
    for (const Triangle& triangle : mesh.triangles) {
        const auto [a, b, c] = corners(mesh.positions, triangle);
        const Vec3 cross = glm::cross(b - a, c - a);
        if (glm::length(cross) == 0.0) {
            continue;
        }
        const Vec3 normal = normalized(cross);
        const double height = glm::dot(normal, point - a);
        if (std::abs(height) > 2.0 * kRadius) {
            continue;
        }
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
            const double gap = distance_to_segment(point, from, to);
            if (gap > 1e-7 && gap < 2.0 * kRadius) {
                return std::nullopt;
            }
        }
        // The circle meets the plane in two directions; a point lies in the triangle if all three
        // edges have it on their inside.
        const Vec3 along = glm::cross(normal, direction);
        const auto is_inside = [&](const Vec3& p, double margin) {
            for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
                if (glm::dot(glm::cross(normal, normalized(to - from)), p - from) < -margin) {
                    return false;
                }
            }
            return true;
        };
        if (!is_inside(point, 2.0 * kRadius)) {
            continue;
        }
        if (glm::length(along) < 0.01 || std::abs(height) > 1e-6) {
            return std::nullopt;
        }
        for (const Vec3& way : {normalized(along), -normalized(along)}) {
            const Vec3 p = point + kRadius * way;
            if (is_inside(p, 2e-6) != is_inside(p, -2e-6)) {
                // In a border that is not the line itself: its other triangle tells.
                if (!is_inside(p, 2e-6)) {
                    return std::nullopt;
                }
            }
            if (is_inside(p, 2e-6)) {
                angles.push_back(std::atan2(glm::dot(way, e2), glm::dot(way, e1)));
            }
        }
    }
    std::sort(angles.begin(), angles.end());
    std::vector<double> distinct;
    for (const double angle : angles) {
        if (distinct.empty() || angle - distinct.back() > 1e-3) {
            distinct.push_back(angle);
        }
    }
    if (distinct.size() > 1 && distinct.front() + 2.0 * math::kPi - distinct.back() <= 1e-3) {
        distinct.pop_back();
    }
    std::vector<double> sectors;
    for (std::size_t i = 0; i < distinct.size(); ++i) {
        const double next =
            i + 1 < distinct.size() ? distinct[i + 1] : distinct.front() + 2.0 * math::kPi;
        const double sine = std::abs(std::sin(math::kPi * math::kPi / (next - distinct[i])));
        if (sine > 0.5e-3 && sine < 2e-3) {
            return std::nullopt;
        }
        if (sine > kMinWedgeSine) {
            sectors.push_back(next - distinct[i]);
        }
    }
    std::sort(sectors.begin(), sectors.end());
    return sectors;
}

std::vector<double> wedges_at(const std::vector<Wedge>& wedges,
                              const Vec3& point,
                              const Vec3& direction) {
    std::vector<double> angles;
    for (const Wedge& wedge : wedges) {
        const Vec3 offset = point - wedge.begin;
        const double z = glm::dot(offset, wedge.direction);
        if (glm::length(offset - z * wedge.direction) < 1e-5 && z > 0.0 && z < wedge.length() &&
            std::abs(glm::dot(wedge.direction, direction)) > 0.9999) {
            angles.push_back(wedge.open_angle);
        }
    }
    std::sort(angles.begin(), angles.end());
    return angles;
}

// Every edge of every triangle of random rooms, whose air is told by a small circle.
TEST(Wedges, AreTheSectorsOfAirAboutEveryTriangleEdge) {
    std::size_t compared = 0;
    std::size_t with_wedges = 0;
    for (std::uint64_t seed = 0; seed < 10 * support::kRoomFamilies; ++seed) {
        const Room room = support::random_room(seed);
        const Facets facets = facets_of_room(room);
        const std::vector<Wedge> wedges = find_wedges(facets);
        for (const Wedge& wedge : wedges) {
            expect_sound_frame(wedge, facets);
        }
        support::Dice dice(seed);
        for (const Triangle& triangle : room.mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& a = room.mesh.positions[triangle[k]];
                const Vec3& b = room.mesh.positions[triangle[(k + 1) % 3]];
                if (glm::distance(a, b) < 2e-3) {
                    continue;
                }
                const Vec3 point = a + dice.between(0.1, 0.9) * (b - a);
                const Vec3 direction = normalized(b - a);
                const auto expected = sectors_about(room.mesh, point, direction);
                if (!expected) {
                    continue;
                }
                const auto found = wedges_at(wedges, point, direction);
                ++compared;
                with_wedges += expected->empty() ? 0 : 1;
                EXPECT_EQ(found.size(), expected->size())
                    << room.kind << " seed " << seed << " at " << point.x << " " << point.y << " "
                    << point.z;
                for (std::size_t i = 0; i < std::min(found.size(), expected->size()); ++i) {
                    EXPECT_NEAR(found[i], (*expected)[i], 1e-3) << room.kind << " seed " << seed;
                }
            }
        }
    }
    EXPECT_GT(compared, 5000U);
    EXPECT_GT(with_wedges, 1000U);
}

bool same_bits(const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::bit_cast<std::uint64_t>(a[axis]) != std::bit_cast<std::uint64_t>(b[axis])) {
            return false;
        }
    }
    return true;
}

void expect_same_bits(const std::vector<Wedge>& found, const std::vector<Wedge>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].faces, expected[i].faces);
        EXPECT_TRUE(same_bits(found[i].begin, expected[i].begin));
        EXPECT_TRUE(same_bits(found[i].end, expected[i].end));
        EXPECT_TRUE(same_bits(found[i].direction, expected[i].direction));
        EXPECT_TRUE(same_bits(found[i].tangent, expected[i].tangent));
        EXPECT_TRUE(same_bits(found[i].normal, expected[i].normal));
        EXPECT_EQ(std::bit_cast<std::uint64_t>(found[i].open_angle),
                  std::bit_cast<std::uint64_t>(expected[i].open_angle));
    }
}

/// Moves some vertices of a room from pose to pose, also back to where they were, by far or by less
/// than the tolerance, or all of them.
void move_vertices(const Mesh& at_rest, support::Dice& dice, Mesh& mesh) {
    const auto count = static_cast<int>(mesh.positions.size());
    const int kind = dice.below(6);
    const int moved = kind == 0 ? 0 : kind == 1 ? count : 1 + dice.below(4);
    const double size = kind == 2 ? 1e-8 : 0.2;
    for (int i = 0; i < moved; ++i) {
        const auto v = static_cast<std::size_t>(moved == count ? i : dice.below(count));
        if (kind == 3) {
            mesh.positions[v] = at_rest.positions[v];
            continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
            mesh.positions[v][axis] += dice.between(-size, size);
        }
    }
}

// Also with triangles that come to nothing in a pose, with other materials, and in another room.
TEST(Wedges, OfFacetsThatMoveAreThoseFoundAfresh) {
    WedgeFinder finder;
    std::size_t lines = 0, kept = 0;
    for (std::uint64_t seed = 0; seed < 3 * support::kRoomFamilies; ++seed) {
        const Mesh at_rest = support::random_room(seed).mesh;
        Room room = support::random_room(seed);
        support::Dice dice(seed + 300);
        for (int pose = 0; pose < 12; ++pose) {
            SCOPED_TRACE(room.kind + " seed " + std::to_string(seed) + " pose " +
                         std::to_string(pose));
            if (pose > 0) {
                move_vertices(at_rest, dice, room.mesh);
            }
            const Facets facets = facets_of_room(room);
            std::vector<std::uint8_t> one_sided(facets.facets.size(), 0);
            std::vector<std::uint8_t> transmissive(facets.facets.size(), 0);
            if (dice.chance(0.2)) {
                one_sided[static_cast<std::size_t>(
                    dice.below(static_cast<int>(one_sided.size())))] = 1;
                transmissive[static_cast<std::size_t>(
                    dice.below(static_cast<int>(transmissive.size())))] = 1;
            }
            const WedgeOptions options{.one_sided = one_sided, .transmissive = transmissive};
            expect_same_bits(finder.find(facets, options), find_wedges(facets, options));
            lines += finder.lines();
            kept += finder.kept_lines();
        }
    }
    EXPECT_GT(4 * kept, lines);
    EXPECT_LT(kept, lines);
}

// A door of one facet turns in a room: the lines of the room away from it stay.
TEST(Wedges, LinesAwayFromWhatMovesAreKept) {
    Room room = support::box_room({0, 0, 0}, {6, 3, 5});
    support::add_hexahedron(room, support::box_corners({4, 0.5, 3}, {5, 1, 4}), Facing::outward, 6);
    const std::size_t first = room.mesh.positions.size();
    support::add_polygon(
        room, std::array{Vec3(1, 0.5, 1), Vec3(2, 0.5, 1), Vec3(2, 2, 1), Vec3(1, 2, 1)}, 12, true);
    WedgeFinder finder;
    finder.find(facets_of_room(room));
    EXPECT_EQ(finder.lines(), 12U + 12U + 4U);
    EXPECT_EQ(finder.kept_lines(), 0U);
    room.mesh.positions[first + 1].z += 0.2;
    room.mesh.positions[first + 2].z += 0.2;
    const Facets facets = facets_of_room(room);
    expect_same_bits(finder.find(facets), find_wedges(facets));
    EXPECT_EQ(finder.kept_lines(), 12U + 12U);
    finder.find(facets);
    EXPECT_EQ(finder.kept_lines(), 12U + 12U + 4U);
}

// Edges far apart on one line are lines of their own, whatever lies beside them.
TEST(Wedges, DoNotDependOnWhatLiesFarAlongTheirLine) {
    const auto sheet = [](Room& room, double x) {
        support::add_polygon(room,
                             std::array{Vec3(x, 0.1, 0.3),
                                        Vec3(x + 0.7, 0.24, 0.3),
                                        Vec3(x + 0.7, 1.24, 0.3),
                                        Vec3(x, 1.1, 0.3)},
                             0,
                             true);
    };
    Room alone;
    sheet(alone, 0.1);
    Room both;
    sheet(both, 0.1);
    support::add_polygon(
        both,
        std::array{
            Vec3(1.6, 0.4, 0.3), Vec3(3.6, 0.8, 0.3), Vec3(3.6, 1.8, 0.3), Vec3(1.6, 1.4, 0.3)},
        0,
        true);
    const std::vector<Wedge> expected = wedges_of(alone);
    std::vector<Wedge> found = wedges_of(both);
    ASSERT_EQ(found.size(), 2 * expected.size());
    found.resize(expected.size());
    expect_same_bits(found, expected);
}

TEST(Wedges, CoordinatesAboutAnEdge) {
    const Wedge wedge = make_wedge({1, 0, 0}, {1, 0, 2}, {3, 0, 1}, 1.5 * math::kPi);
    const WedgePoint above = wedge_coordinates(wedge, {1, 2, 0.5});
    EXPECT_DOUBLE_EQ(above.radius, 2.0);
    EXPECT_DOUBLE_EQ(above.angle, 0.5 * math::kPi);
    EXPECT_DOUBLE_EQ(above.z, 0.5);
    EXPECT_DOUBLE_EQ(wedge_coordinates(wedge, {1, -1, -3}).angle, 1.5 * math::kPi);
    EXPECT_DOUBLE_EQ(wedge_coordinates(wedge, {0, 0, 0}).angle, math::kPi);
}

}  // namespace
}  // namespace earshot::geometry
