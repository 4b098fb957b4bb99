// SPDX-License-Identifier: MIT
#include "earshot/frustum/edge_pair_paths.h"

#include "earshot/geometry/vector.h"
#include "earshot/geometry/wedges.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "frustum/edge_rooms.h"
#include "frustum/meshed_scene.h"
#include "support/air.h"
#include "support/dice.h"
#include "support/image_source_oracle.h"
#include "support/random_rooms.h"
#include "support/rooms.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace earshot::frustum {
namespace {

using geometry::Vec3;
using geometry::Wedge;
using support::Room;

EdgePairResult paths_of(const Room& room, const Vec3& source, const Vec3& listener) {
    const MeshedScene scene(room.mesh, room.labels);
    return find_edge_pair_paths(
        scene.scene_view(), geometry::find_wedges(scene.facets()), source, std::array{listener});
}

// Along both sides of it: twelve pairs of edges in order.
TEST(EdgePairPaths, RunAlongBothSidesOfAScreen) {
    const auto found = paths_of(screen(), {0.1, 0.2, 2.0}, {-0.3, 0.1, -1.0});
    ASSERT_EQ(found.paths.size(), 24U);
    for (const EdgePairPath& path : found.paths) {
        EXPECT_TRUE(path.common_face.has_value());
        EXPECT_FALSE(path.is_sampled);
        ASSERT_EQ(path.links.size(), 1U);
        EXPECT_DOUBLE_EQ(path.links[0].first.min, 0.0);
        EXPECT_DOUBLE_EQ(path.links[0].second.min, 0.0);
    }
}

// Of a box the upper edges that border on its top, and those of one side.
TEST(EdgePairPaths, RunOverTheTopOfABlock) {
    Room room;
    support::add_hexahedron(
        room, support::box_corners({-1, -1, -0.5}, {1, 1, 0.5}), support::Facing::outward, 0);
    const auto found = paths_of(room, {0.1, 0.2, 3.0}, {0.2, 0.3, -3.0});
    // From the four edges of the face before the source, each to the opposite edge behind.
    ASSERT_EQ(found.paths.size(), 4U);
    for (const EdgePairPath& path : found.paths) {
        EXPECT_TRUE(path.common_face.has_value());
        EXPECT_FALSE(path.is_sampled);
    }
}

/// How many ways there are through the air between horizontal edges at two places.
std::array<int, 2> count_between(const Room& room, const Vec3& on_first, const Vec3& on_second) {
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    const auto found = find_edge_pair_paths(
        scene.scene_view(), wedges, {0.1, 0.2, 2.0}, std::array{Vec3(-0.3, 0.1, -4.0)});
    const auto is_at = [&](std::size_t wedge, const Vec3& place) {
        return wedges[wedge].begin.y == place.y && wedges[wedge].end.y == place.y &&
               wedges[wedge].begin.z == place.z;
    };
    std::array<int, 2> count{};  // certain, sampled
    for (const EdgePairPath& path : found.paths) {
        if (is_at(path.first, on_first) && is_at(path.second, on_second) && !path.common_face) {
            ++count[path.is_sampled ? 1 : 0];
        }
    }
    return count;
}

// What lies behind a gap of a wall is hidden from one half of an edge: of its eight slices those
// that see all of the other edge are one link.
TEST(EdgePairPaths, JoinSlicesThatSeeTheSame) {
    Room room = screen();
    support::add_polygon(
        room,
        std::array{Vec3(-0.1, -0.5, -2), Vec3(0, -0.5, -2), Vec3(0, 0.5, -2), Vec3(-0.1, 0.5, -2)},
        1,
        true);
    // Touches no way from the end of the first edge.
    support::add_polygon(
        room,
        std::array{Vec3(-9, -9, -1), Vec3(-0.4, -9, -1), Vec3(-0.4, 9, -1), Vec3(-9, 9, -1)},
        2,
        true);
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    const auto found = find_edge_pair_paths(
        scene.scene_view(), wedges, {0.1, 0.2, 2.0}, std::array{Vec3(0.3, 0.1, -4.0)});
    std::size_t compared = 0;
    for (const EdgePairPath& path : found.paths) {
        const Wedge& first = wedges[path.first];
        const Wedge& second = wedges[path.second];
        if (path.is_sampled && first.begin.z == 0.0 && first.length() == 2.0 &&
            second.begin.z == -2.0 && second.begin.y == second.end.y) {
            // All from where the second edge is seen past the wall, at -0.75 and right of it.
            ASSERT_EQ(path.links.size(), 1U);
            EXPECT_DOUBLE_EQ(path.links[0].first.max - path.links[0].first.min, 1.75);
            ++compared;
        }
    }
    EXPECT_GT(compared, 0U);
}

// From screen to screen, and not where a third one stands between.
TEST(EdgePairPaths, RunThroughTheAirBetweenScreens) {
    Room room = screen();
    support::add_polygon(
        room,
        std::array{Vec3(-1, -0.5, -2), Vec3(1, -0.5, -2), Vec3(1, 0.5, -2), Vec3(-1, 0.5, -2)},
        1,
        true);
    const Vec3 top(0, 0.5, 0), bottom(0, -0.5, 0), far_top(0, 0.5, -2), far_bottom(0, -0.5, -2);
    EXPECT_EQ(count_between(room, top, far_top), (std::array{1, 0}));
    EXPECT_EQ(count_between(room, bottom, far_bottom), (std::array{1, 0}));
    // In the way of the lower edges, and of half of those from the upper to the lower ones.
    support::add_polygon(
        room,
        std::array{Vec3(-3, -3, -1), Vec3(0, -3, -1), Vec3(0, 0.1, -1), Vec3(-3, 0.1, -1)},
        2,
        true);
    EXPECT_EQ(count_between(room, top, far_top), (std::array{1, 0}));
    EXPECT_EQ(count_between(room, bottom, far_bottom), (std::array{0, 1}));
    EXPECT_EQ(count_between(room, top, far_bottom), (std::array{0, 1}));
}

struct Sample {
    std::size_t wedge = 0;
    double z = 0.0;
};

/// A kind of way between two edges: through the air, or along a face of both.
struct WayKind {
    int first_face = -1;
    int second_face = -1;
};

constexpr double kOffset = 1e-5;

/// A place a hair off an edge: in the middle of its air, or above one of its faces.
Vec3 beside(const Wedge& wedge, double z, int face) {
    const double quarter = std::min(std::acos(0.0), 0.5 * wedge.open_angle);
    const double angle = face < 0    ? 0.5 * wedge.open_angle
                         : face == 0 ? quarter
                                     : wedge.open_angle - quarter;
    return wedge.point_at(z) +
           kOffset * (std::cos(angle) * wedge.tangent + std::sin(angle) * wedge.normal);
}

/// How far a point lies from the planes of a wedge's faces, within its air; below 0 outside.
double height_in_air(const Wedge& wedge, const Vec3& point) {
    const geometry::WedgePoint at = geometry::wedge_coordinates(wedge, point);
    const auto over = [&](double angle) {
        return angle < std::acos(0.0) ? at.radius * std::sin(angle) : at.radius;
    };
    return at.angle > wedge.open_angle
               ? -1.0
               : std::min(over(at.angle), over(wedge.open_angle - at.angle));
}

class PairOracle {
public:
    PairOracle(const Room& room, const std::vector<Wedge>& wedges) : room_(room), wedges_(wedges) {}

    /// How certain it is that a straight way between two points is free.
    std::vector<double> margins(const Vec3& from, const std::vector<Vec3>& places) const {
        std::vector<double> margins(places.size(), -1.0);
        const auto result = support::search_image_sources(
            room_.mesh.view(), room_.labels, from, places, {.max_order = 0});
        for (const auto* list : {&result.paths, &result.ambiguous}) {
            for (const support::OraclePath& path : *list) {
                margins[path.listener] = std::max(margins[path.listener], path.margin);
            }
        }
        return margins;
    }
    /// Samples that are reached from a point, with how certain that is.
    std::vector<std::pair<Sample, double>> reached(const Vec3& point,
                                                   const std::vector<Sample>& samples) const {
        std::vector<Vec3> places;
        for (const Sample& sample : samples) {
            places.push_back(beside(wedges_[sample.wedge], sample.z, -1));
        }
        const std::vector<double> found = margins(point, places);
        std::vector<std::pair<Sample, double>> reached;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (found[i] > 0.0) {
                reached.emplace_back(samples[i], found[i]);
            }
        }
        return reached;
    }
    std::vector<WayKind> kinds(std::size_t first, std::size_t second) const {
        std::vector<WayKind> kinds{{}};
        for (int i = 0; i < 2; ++i) {
            for (int k = 0; k < 2; ++k) {
                if (wedges_[first].faces[static_cast<std::size_t>(i)] ==
                    wedges_[second].faces[static_cast<std::size_t>(k)]) {
                    kinds.push_back({i, k});
                }
            }
        }
        return kinds;
    }

private:
    const Room& room_;
    const std::vector<Wedge>& wedges_;
};

/// What a path has to say of a place on each edge.
struct Presence {
    int links = 0;
    double inside = 0.0;  ///< metres from the ends of the link
    bool is_sampled = false;
};

Presence presence(const std::vector<EdgePairPath>& paths,
                  const Sample& first,
                  const Sample& second,
                  const WayKind& kind) {
    Presence present;
    for (const EdgePairPath& path : paths) {
        const std::array<int, 2> face = path.common_face.value_or(std::array{-1, -1});
        if (path.first != first.wedge || path.second != second.wedge ||
            face != std::array{kind.first_face, kind.second_face}) {
            continue;
        }
        present.is_sampled = present.is_sampled || path.is_sampled;
        for (const EdgeLink& link : path.links) {
            const double inside = std::min({first.z - link.first.min,
                                            link.first.max - first.z,
                                            second.z - link.second.min,
                                            link.second.max - second.z});
            if (inside >= 0.0) {
                ++present.links;
                present.inside = std::max(present.inside, inside);
            }
        }
    }
    return present;
}

struct Counts {
    std::size_t compared = 0, present = 0, missed = 0, false_ones = 0, doubled = 0, doubtful = 0,
                sampled = 0, sampled_unlike = 0;
};

using Reached = std::pair<Sample, double>;  // with how certain that is

// The ways that leave one edge through the air or along one of its faces.
void compare_ways(const Room& room,
                  const std::vector<Wedge>& wedges,
                  const EdgePairResult& found,
                  const Reached& from,
                  const std::vector<Reached>& to_listener,
                  int face,
                  std::uint64_t seed,
                  Counts& counts) {
    const PairOracle oracle(room, wedges);
    const Wedge& a = wedges[from.first.wedge];
    const Vec3 start = a.point_at(from.first.z);
    std::vector<std::pair<Reached, WayKind>> ways;
    std::vector<Vec3> places;
    for (const Reached& to : to_listener) {
        const Wedge& b = wedges[to.first.wedge];
        if (to.first.wedge == from.first.wedge ||
            glm::distance(start, b.point_at(to.first.z)) < 0.01) {
            continue;
        }
        for (const WayKind& kind : oracle.kinds(from.first.wedge, to.first.wedge)) {
            if (kind.first_face == face) {
                ways.emplace_back(to, kind);
                places.push_back(beside(b, to.first.z, kind.second_face));
            }
        }
    }
    const std::vector<double> margins = oracle.margins(beside(a, from.first.z, face), places);
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const auto& [to, kind] = ways[i];
        const Wedge& b = wedges[to.first.wedge];
        double margin = std::min({margins[i], from.second, to.second});
        double grazing = 1.0;
        if (face < 0) {
            grazing = std::min(height_in_air(a, b.point_at(to.first.z)), height_in_air(b, start));
            margin = grazing < 0.0 ? -1.0 : margin;
        }
        const Presence has = presence(found.paths, from.first, to.first, kind);
        ++counts.compared;
        counts.present += has.links > 0 ? 1 : 0;
        counts.doubled += has.links > 1 ? 1 : 0;
        const bool is_unlike = (margin > 0.0) != (has.links > 0);
        if (has.is_sampled) {
            ++counts.sampled;
            counts.sampled_unlike += is_unlike ? 1 : 0;
            continue;
        }
        if (!is_unlike) {
            continue;
        }
        // Beside an edge, ways close to a face or past another edge are told otherwise.
        if (std::abs(grazing) < 4.0 * kOffset ||
            (margin > 0.0 ? margin <= 2.0 * kOffset : has.inside <= 0.02)) {
            ++counts.doubtful;
            continue;
        }
        ++(margin > 0.0 ? counts.missed : counts.false_ones);
        ADD_FAILURE() << (margin > 0.0 ? "missed" : "false") << ": seed " << seed << " "
                      << room.kind << " wedges " << from.first.wedge << " " << to.first.wedge
                      << " faces " << kind.first_face << " " << kind.second_face << " margin "
                      << margin << " inside " << has.inside << " grazing " << grazing << " margins "
                      << from.second << " " << to.second;
    }
}

// Ways from sample to sample, a hair off the edges, by an independent search in extended precision.
void compare_with_oracle(std::uint64_t seed, Counts& counts) {
    const LabelledRoom labelled(seed);
    const Room& room = labelled.room;
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    support::Dice dice(seed + 5000);
    const Vec3 source = support::random_air_point(room, dice);
    const Vec3 listener = support::random_air_point(room, dice);
    const auto found =
        find_edge_pair_paths(scene.scene_view(), wedges, source, std::array{listener});
    std::vector<Sample> samples;
    for (std::size_t w = 0; w < wedges.size(); ++w) {
        samples.push_back({w, dice.between(0.0, wedges[w].length())});
    }
    const PairOracle oracle(room, wedges);
    const auto from_source = oracle.reached(source, samples);
    const auto to_listener = oracle.reached(listener, samples);
    // Some of the first edges with all of the second ones.
    constexpr std::size_t kMaxFirst = 12;
    const std::size_t stride = 1 + from_source.size() / kMaxFirst;
    for (std::size_t i = seed % stride; i < from_source.size(); i += stride) {
        for (const int face : {-1, 0, 1}) {
            compare_ways(room, wedges, found, from_source[i], to_listener, face, seed, counts);
        }
    }
}

// A hundred rooms take 40 seconds of processor time.
TEST(EdgePairPaths, AreThoseOfAnIndependentSearch) {
    constexpr std::uint64_t kRooms = 2 * support::kRoomFamilies;
    Counts counts;
    for (std::uint64_t seed = 0; seed < kRooms; ++seed) {
        compare_with_oracle(seed, counts);
    }
    EXPECT_GT(counts.present, 1500U);
    EXPECT_LT(20 * counts.doubtful, counts.compared);
    // Samples of the edges are not exact, and not far off.
    EXPECT_LT(20 * counts.sampled_unlike, counts.sampled);
    EXPECT_EQ(counts.missed, 0U);
    EXPECT_EQ(counts.false_ones, 0U);
    EXPECT_EQ(counts.doubled, 0U);
}

}  // namespace
}  // namespace earshot::frustum
