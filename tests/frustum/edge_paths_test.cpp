// SPDX-License-Identifier: MIT
#include "earshot/frustum/edge_paths.h"

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
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace earshot::frustum {
namespace {

using geometry::FacetId;
using geometry::Vec3;
using geometry::Wedge;
using support::Room;

using Sequence = std::vector<FacetId>;

EdgePathResult paths_of(const Room& room,
                        const Vec3& source,
                        const Vec3& listener,
                        int reflections = 0) {
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    return find_edge_paths(
        scene.scene_view(), wedges, source, std::array{listener}, {.max_reflections = reflections});
}

TEST(EdgePaths, AScreenIsPassedOverItsFourEdgesWhole) {
    const auto found = paths_of(screen(), {0.1, 0.2, 2.0}, {-0.3, 0.1, -1.0});
    ASSERT_EQ(found.paths.size(), 4U);
    double sum = 0.0;
    for (const EdgePath& path : found.paths) {
        EXPECT_TRUE(path.before.empty() && path.after.empty());
        EXPECT_DOUBLE_EQ(path.part.min, 0.0);
        sum += path.part.max;
    }
    EXPECT_DOUBLE_EQ(sum, 6.0);
}

TEST(EdgePaths, EdgesAreReachedInThePlaneOfTheScreen) {
    const auto found = paths_of(screen(), {2.0, 0.2, 0.0}, {-3.0, 0.1, -1.0});
    ASSERT_EQ(found.paths.size(), 1U);  // the near edge; the others are seen along the screen
    EXPECT_DOUBLE_EQ(found.paths[0].part.max, 1.0);
}

// A square of half the screen's width in the way: its shadow on the upper edge ends where the lines
// past its sides do.
TEST(EdgePaths, AnObstacleHidesItsShadow) {
    Room room = screen();
    support::add_polygon(
        room,
        std::array{Vec3(-0.2, 0.0, 1), Vec3(0.2, 0.0, 1), Vec3(0.2, 0.4, 1), Vec3(-0.2, 0.4, 1)},
        1,
        true);
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    const Vec3 source(0, 0, 2), listener(0, 0, -1);
    const auto found =
        find_edge_paths(scene.scene_view(), wedges, source, std::array{listener}, {});
    std::vector<double> ends;
    for (const EdgePath& path : found.paths) {
        const Wedge& wedge = wedges[path.wedge];
        if (wedge.begin.z == 0.0 && wedge.begin.y == 0.5 && wedge.end.y == 0.5) {
            ends.push_back(wedge.point_at(path.part.min).x);
            ends.push_back(wedge.point_at(path.part.max).x);
        }
    }
    std::sort(ends.begin(), ends.end());
    ASSERT_EQ(ends.size(), 4U);
    EXPECT_NEAR(ends[0], -1.0, 1e-12);
    EXPECT_NEAR(ends[1], -0.4, 1e-12);
    EXPECT_NEAR(ends[2], 0.4, 1e-12);
    EXPECT_NEAR(ends[3], 1.0, 1e-12);
}

// The floor has an image of the source, seen from the part of the lower edge over which its
// reflections lie in the floor.
TEST(EdgePaths, AFloorReflectsWithinItsOutline) {
    Room room = screen();
    support::add_polygon(
        room,
        std::array{Vec3(-0.5, -1, 0.2), Vec3(-0.5, -1, 3), Vec3(0.5, -1, 3), Vec3(0.5, -1, 0.2)},
        1,
        true);
    const MeshedScene scene(room.mesh, room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    const Vec3 source(0, 0, 2), listener(0, 1, -1);
    const auto found = find_edge_paths(
        scene.scene_view(), wedges, source, std::array{listener}, {.max_reflections = 1});
    std::size_t lower = 0;
    for (const EdgePath& path : found.paths) {
        const Wedge& wedge = wedges[path.wedge];
        if (path.before.size() == 1 && wedge.begin.y == -0.5 && wedge.end.y == -0.5) {
            ++lower;
            // From the image (0, -2, 2) to (x, -0.5, 0): at y = -1 two thirds of the way.
            EXPECT_NEAR(std::abs(wedge.point_at(path.part.min).x), 0.75, 1e-9);
            EXPECT_NEAR(std::abs(wedge.point_at(path.part.max).x), 0.75, 1e-9);
            const auto points = points_of(path, scene.scene_view(), wedges, source, listener);
            ASSERT_EQ(points.size(), 4U);
            EXPECT_NEAR(points[1].y, -1.0, 1e-12);
            EXPECT_NEAR(points[2].y, -0.5, 1e-12);
            double length = 0.0;
            for (std::size_t i = 0; i + 1 < points.size(); ++i) {
                length += glm::distance(points[i], points[i + 1]);
            }
            EXPECT_NEAR(length, path.length, 1e-12);
        }
    }
    EXPECT_EQ(lower, 1U);
}

void expect_same(const std::vector<EdgePath>& found, const std::vector<EdgePath>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].listener, expected[i].listener);
        EXPECT_EQ(found[i].wedge, expected[i].wedge);
        EXPECT_EQ(found[i].before, expected[i].before);
        EXPECT_EQ(found[i].after, expected[i].after);
        EXPECT_EQ(found[i].part.min, expected[i].part.min);
        EXPECT_EQ(found[i].part.max, expected[i].part.max);
    }
}

TEST(EdgePaths, FrustaMissNoCandidate) {
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < 4 * support::kRoomFamilies; ++seed) {
        const LabelledRoom labelled(seed);
        const Room& room = labelled.room;
        const MeshedScene scene(room.mesh, room.labels);
        const auto wedges = geometry::find_wedges(scene.facets());
        support::Dice dice(seed);
        const Vec3 source = support::random_air_point(room, dice);
        const std::array listeners{support::random_air_point(room, dice),
                                   support::aimed_air_point(room, source, dice)};
        const EdgePathOptions options{
            .max_reflections = scene.facets().facets.size() * wedges.size() < 1500 ? 1 : 0};
        const auto found = find_edge_paths(scene.scene_view(), wedges, source, listeners, options);
        const auto expected =
            find_edge_paths_brute_force(scene.scene_view(), wedges, source, listeners, options);
        SCOPED_TRACE("seed " + std::to_string(seed));
        expect_same(found.paths, expected.paths);
        paths += found.paths.size();
    }
    EXPECT_GT(paths, 1000U);
}

TEST(EdgePaths, AreTheSameInAnyTree) {
    const LabelledRoom labelled(3);
    const geometry::Mesh& mesh = labelled.room.mesh;
    const MeshedScene scene(mesh, labelled.room.labels);
    const auto wedges = geometry::find_wedges(scene.facets());
    support::Dice dice(3);
    const Vec3 source = support::random_air_point(labelled.room, dice);
    const std::array listeners{support::random_air_point(labelled.room, dice)};
    const auto expected =
        find_edge_paths(scene.scene_view(), wedges, source, listeners, {.max_reflections = 1});
    EXPECT_GT(expected.paths.size(), 0U);
    for (const bvh::Builder builder : {bvh::Builder::sweep_sah,
                                       bvh::Builder::spatial_median,
                                       bvh::Builder::quality,
                                       bvh::Builder::lbvh,
                                       bvh::Builder::hybrid,
                                       bvh::Builder::fast}) {
        SceneView view = scene.scene_view();
        const bvh::DeformableBvh tree(view.mesh(), {.build = {.builder = builder}});
        const SceneView other{.bvh = {tree.tree(), view.mesh()}, .facets = view.facets};
        Executor two(2);
        expect_same(
            find_edge_paths(other, wedges, source, listeners, {.max_reflections = 1}, two).paths,
            expected.paths);
    }
}

/// Wants ways whose lines over the edge's line are at most so long.
class LengthFilter final : public EdgePathFilter {
public:
    explicit LengthFilter(double max_length) : max_length_(max_length) {}
    bool may_be_wanted(const Wedge&,
                       const geometry::Interval&,
                       const EdgeEnd& source,
                       const EdgeEnd& listener,
                       std::size_t) const override {
        return is_wanted(source.image, listener.image);
    }
    bool is_wanted(const geometry::WedgePoint& source, const geometry::WedgePoint& listener) const {
        return std::hypot(source.radius + listener.radius, source.z - listener.z) <= max_length_;
    }

private:
    double max_length_;
};

// A filter leaves out what it refuses and nothing else, from source to source.
TEST(EdgePaths, AFilterLeavesOutWhatItRefusesOnly) {
    std::size_t wanted = 0, all = 0;
    for (std::uint64_t seed = 0; seed < support::kRoomFamilies; ++seed) {
        const LabelledRoom labelled(seed);
        const Room& room = labelled.room;
        const MeshedScene scene(room.mesh, room.labels);
        const auto wedges = geometry::find_wedges(scene.facets());
        support::Dice dice(seed + 2000);
        const std::array listeners{support::random_air_point(room, dice),
                                   support::random_air_point(room, dice)};
        const EdgePathOptions options{.max_reflections = 1};
        const SceneView view = scene.scene_view();
        EdgePathFinder finder(view, wedges, options);
        for (int i = 0; i < 2; ++i) {
            const Vec3 source = support::random_air_point(room, dice);
            const auto complete = find_edge_paths(view, wedges, source, listeners, options);
            double middle = 0.0;
            for (const EdgePath& path : complete.paths) {
                middle += path.length / static_cast<double>(complete.paths.size());
            }
            const LengthFilter filter(middle);
            std::vector<EdgePath> expected;
            for (const EdgePath& path : complete.paths) {
                const Wedge& wedge = wedges[path.wedge];
                if (filter.is_wanted(geometry::wedge_coordinates(wedge, path.source_image),
                                     geometry::wedge_coordinates(wedge, path.listener_image))) {
                    expected.push_back(path);
                }
            }
            SCOPED_TRACE("seed " + std::to_string(seed));
            expect_same(finder.find(source, listeners, &filter).paths, expected);
            wanted += expected.size();
            all += complete.paths.size();
        }
    }
    EXPECT_GT(wanted, 1000U);
    EXPECT_LT(wanted, all);
}

// Sources and listeners move by turns. What a point reaches is traced when it is new, and once.
TEST(EdgePaths, KeptTracesGiveThePathsOfFreshOnes) {
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < support::kRoomFamilies; ++seed) {
        const LabelledRoom labelled(seed);
        const Room& room = labelled.room;
        const MeshedScene scene(room.mesh, room.labels);
        const auto wedges = geometry::find_wedges(scene.facets());
        support::Dice dice(seed + 3000);
        std::array sources{support::random_air_point(room, dice),
                           support::random_air_point(room, dice)};
        // One listener is where a source is.
        std::array listeners{support::random_air_point(room, dice), sources[1]};
        const SceneView view = scene.scene_view();
        EdgePathFinder keeping(view, wedges, {.max_reflections = 1, .keep_traces = true});
        SCOPED_TRACE("seed " + std::to_string(seed));
        for (int step = 0; step < 6; ++step) {
            const bool source_moves = step == 2 || step == 4;
            const bool listener_moves = step == 3 || step == 4;
            if (source_moves) {
                sources[0] = support::random_air_point(room, dice);
            }
            if (listener_moves) {
                listeners[0] = support::random_air_point(room, dice);
            }
            for (std::size_t i = 0; i < sources.size(); ++i) {
                const auto fresh =
                    find_edge_paths(view, wedges, sources[i], listeners, {.max_reflections = 1});
                const auto kept = keeping.find(sources[i], listeners);
                expect_same(kept.paths, fresh.paths);
                const bool is_new = step == 0 || (i == 0 && (source_moves || listener_moves));
                EXPECT_EQ(kept.statistics.frusta > 0, is_new) << "step " << step;
                paths += kept.paths.size();
            }
            keeping.discard_unused();
        }
    }
    EXPECT_GT(paths, 5000U);
}

/// What the oracle knows of the ways from a point to places beside edges: per place the sequences
/// of facets, with how certain each is.
using Reached = std::vector<std::map<Sequence, double>>;

Reached reached_by_oracle(const Room& room,
                          const Vec3& point,
                          const std::vector<Vec3>& places,
                          int reflections) {
    const auto result = support::search_image_sources(
        room.mesh.view(), room.labels, point, places, {.max_order = reflections});
    Reached reached(places.size());
    for (const auto* list : {&result.paths, &result.ambiguous}) {
        for (const support::OraclePath& path : *list) {
            double& margin = reached[path.listener].try_emplace(path.labels, -1.0).first->second;
            margin = std::max(margin, path.margin);
        }
    }
    return reached;
}

struct Sample {
    std::size_t wedge = 0;
    double z = 0.0;
};

// An independent search for specular paths ends a hair off the edge, in the middle of its air.
// Whether it reaches the place must be what the parts of the edge say.
TEST(EdgePaths, PartsAreWhatAnIndependentSearchReaches) {
    constexpr double kOffset = 1e-5;
    constexpr int kSamples = 4;
    std::size_t compared = 0, doubtful = 0, contributions = 0;
    for (std::uint64_t seed = 0; seed < 4 * support::kRoomFamilies; ++seed) {
        const LabelledRoom labelled(seed);
        const Room& room = labelled.room;
        const MeshedScene scene(room.mesh, room.labels);
        const auto wedges = geometry::find_wedges(scene.facets());
        support::Dice dice(seed + 1000);
        const Vec3 source = support::random_air_point(room, dice);
        const Vec3 listener = support::random_air_point(room, dice);
        const int reflections = scene.facets().facets.size() <= 25 ? 2 : 1;
        const auto found = find_edge_paths(scene.scene_view(),
                                           wedges,
                                           source,
                                           std::array{listener},
                                           {.max_reflections = reflections});
        std::vector<Sample> samples;
        std::vector<Vec3> places;
        for (std::size_t w = 0; w < wedges.size(); ++w) {
            const Wedge& wedge = wedges[w];
            const double middle = 0.5 * wedge.open_angle;
            const Vec3 off = std::cos(middle) * wedge.tangent + std::sin(middle) * wedge.normal;
            for (int i = 0; i < kSamples; ++i) {
                samples.push_back({w, dice.between(0.0, wedge.length())});
                places.push_back(wedge.point_at(samples.back().z) + kOffset * off);
            }
        }
        const Reached from_source = reached_by_oracle(room, source, places, reflections);
        const Reached from_listener = reached_by_oracle(room, listener, places, reflections);
        for (std::size_t s = 0; s < samples.size(); ++s) {
            // Per pair of sequences: how clearly the oracle has it.
            std::map<std::pair<Sequence, Sequence>, double> expected;
            for (const auto& [before, margin] : from_source[s]) {
                for (const auto& [after, other] : from_listener[s]) {
                    // Beside the edge, its faces reflect: on the edge itself they do not.
                    const auto& faces = wedges[samples[s].wedge].faces;
                    const auto ends_in_face = [&](const Sequence& sequence) {
                        return !sequence.empty() && (sequence.back() == faces[0].facet ||
                                                     sequence.back() == faces[1].facet);
                    };
                    if (!ends_in_face(before) && !ends_in_face(after) &&
                        before.size() + after.size() <= static_cast<std::size_t>(reflections)) {
                        expected[{before, {after.rbegin(), after.rend()}}] =
                            std::min(margin, other);
                    }
                }
            }
            std::set<std::pair<Sequence, Sequence>> present;
            for (const EdgePath& path : found.paths) {
                const double inside =
                    std::min(samples[s].z - path.part.min, path.part.max - samples[s].z);
                if (path.wedge != samples[s].wedge || inside < 0.0) {
                    continue;
                }
                const std::pair key(path.before, path.after);
                EXPECT_TRUE(present.insert(key).second) << "doubled, seed " << seed;
                const auto match = expected.find(key);
                if (match == expected.end() && inside > 0.02) {
                    ADD_FAILURE() << "false: seed " << seed << " " << room.kind << " wedge "
                                  << path.wedge << " z " << samples[s].z << " before "
                                  << path.before.size() << " after " << path.after.size();
                } else if (match == expected.end()) {
                    ++doubtful;
                }
            }
            for (const auto& [key, margin] : expected) {
                ++compared;
                if (present.count(key) == 0 && margin > kOffset) {
                    ADD_FAILURE() << "missed: seed " << seed << " " << room.kind << " wedge "
                                  << samples[s].wedge << " z " << samples[s].z << " before "
                                  << key.first.size() << " after " << key.second.size()
                                  << " margin " << margin;
                } else if (present.count(key) == 0) {
                    ++doubtful;
                }
            }
            contributions += present.size();
        }
    }
    EXPECT_GT(contributions, 30000U);
    EXPECT_LT(doubtful * 50, compared);
}

}  // namespace
}  // namespace earshot::frustum
