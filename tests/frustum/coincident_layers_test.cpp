// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/coincident_layers.h"

#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"
#include "earshot/frustum/layer_overlaps.h"

#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>
#include <vector>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

/// A floor of 10 x 10 m per height, in the order given; they span the same square.
QuadRoom floors(const std::vector<double>& heights) {
    QuadRoom room;
    for (const double y : heights) {
        room.add_quad({-5, y, -5}, {-5, y, 5}, {5, y, 5}, {5, y, -5});
    }
    room.finish();
    return room;
}

const Vec3 kAbove = {-1.0, 1.0, 0.0};
const std::vector<Vec3> kListeners = {{1.5, 1.3, 0.2}, {1.5, -0.7, 0.2}};  // above and below

TEST(CoincidentLayers, NoPathFitsBetweenThem) {
    for (const double gap : {1e-12, 1e-9, 1e-8, 1e-6}) {
        for (const std::vector<double>& heights : {std::vector<double>{0.0, -gap},
                                                   std::vector<double>{-gap, 0.0},
                                                   std::vector<double>{0.0, -gap, gap}}) {
            const QuadRoom room = floors(heights);
            const auto found =
                find_specular_paths(room.scene_view(), kAbove, kListeners, {.max_order = 5});
            ASSERT_EQ(found.paths.size(), 2U) << "gap " << gap;  // direct and one reflection
            EXPECT_EQ(found.paths[1].triangles.size(), 1U);
            EXPECT_LT(found.paths[1].triangles[0], 2U);  // of the first floor
        }
    }
}

TEST(CoincidentLayers, TransmitAsOne) {
    const QuadRoom room = floors({0.0, -1e-8, 1e-8});
    SceneView scene_view = room.scene_view();
    const std::vector<std::uint8_t> all = {1, 1, 1};
    scene_view.transmissive = all;
    const auto found = find_specular_paths(scene_view, kAbove, kListeners, {.max_order = 4});
    ASSERT_EQ(found.paths.size(), 3U);
    const SpecularPath& through = found.paths[2];
    EXPECT_EQ(through.listener, 1U);
    EXPECT_EQ(through.transmitted, std::vector<std::uint8_t>{1});
    EXPECT_LT(through.triangles[0], 2U);
}

TEST(CoincidentLayers, TheFirstInTheFileDecidesWhetherSoundPasses) {
    for (const double height : {-1e-8, 1e-8}) {
        for (const bool transmissive_first : {true, false}) {
            const QuadRoom room = floors({0.0, height});
            SceneView scene_view = room.scene_view();
            const std::vector<std::uint8_t> transmissive = {
                static_cast<std::uint8_t>(transmissive_first ? 1 : 0),
                static_cast<std::uint8_t>(transmissive_first ? 0 : 1)};
            scene_view.transmissive = transmissive;
            const auto found =
                find_specular_paths(scene_view, kAbove, kListeners, {.max_order = 2});
            EXPECT_EQ(found.paths.size(), transmissive_first ? 3U : 2U);
            EXPECT_TRUE(
                std::all_of(found.paths.begin(), found.paths.end(), [](const SpecularPath& path) {
                    return path.triangles.empty() || path.triangles[0] < 2;
                }));
        }
    }
}

// An opaque layer behind a transmissive one hides nothing, and two layers are two facets for the
// search: complete mode against every sequence.
TEST(CoincidentLayers, NothingIsMissedInRandomRoomsWithLayersOnTheWalls) {
    std::size_t through = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        QuadRoom room;
        room.add_box(Vec3(0.0), {6, 0, 0}, {0, 3, 0}, {0, 0, 5}, true);
        // A transmissive partition, an opaque layer that covers a part of it, a poster on a wall.
        const double x = random_between(seed, 0, 0, 1.5, 4.5);
        const double gap = random_between(seed, 0, 1, -1e-7, 1e-7);
        const double low = random_between(seed, 0, 2, 0.1, 2.0);
        room.add_quad({x, 0, 0}, {x, 3, 0}, {x, 3, 5}, {x, 0, 5});
        room.add_quad({x + gap, low, 0.3}, {x + gap, 3, 0.3}, {x + gap, 3, 3}, {x + gap, low, 3});
        room.add_quad({1, -gap, 1}, {1, -gap, 3}, {4, -gap, 3}, {4, -gap, 1});
        room.finish();
        SceneView scene_view = room.scene_view();
        std::vector<std::uint8_t> transmissive(9, 0);
        transmissive[6] = 1;
        transmissive[8] = seed % 2 == 0 ? 1 : 0;
        scene_view.transmissive = transmissive;
        const auto point = [&](std::uint64_t stream) {
            return Vec3(random_between(seed, stream, 0, 0.1, 5.9),
                        random_between(seed, stream, 1, 0.1, 2.9),
                        random_between(seed, stream, 2, 0.1, 4.9));
        };
        const Vec3 source = point(1);
        const std::vector<Vec3> listeners = {point(2), point(3), point(4)};
        const auto expected = find_specular_paths_brute_force(scene_view, source, listeners, 3);
        const auto found = find_specular_paths(scene_view, source, listeners, {.max_order = 3});
        EXPECT_EQ(found.paths, expected.paths) << seed;
        for (const SpecularPath& path : found.paths) {
            through += path.transmitted.empty() ? 0 : 1;
            for (std::size_t i = 0; i < path.triangles.size(); ++i) {
                // Neither the opaque layer nor the poster is first at its place.
                EXPECT_LT(path.triangles[i], 14U) << seed;
            }
        }
    }
    EXPECT_GT(through, 100U);
}

TEST(LayerOverlaps, AreTheCommonPartsOfDifferentLabels) {
    QuadRoom room;
    room.add_quad({0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0});
    room.add_quad({3, 1e-8, 1}, {3, 1e-8, 3}, {6, 1e-8, 3}, {6, 1e-8, 1});  // half on it
    room.add_quad({4, 0, 0}, {4, 0, 4}, {5, 0, 4}, {5, 0, 0});              // beside it
    room.add_quad({1, 1e-3, 1}, {1, 1e-3, 2}, {2, 1e-3, 2}, {2, 1e-3, 1});  // a millimetre above
    room.add_quad({0, 0, 0}, {0, 2, 0}, {4, 2, 0}, {4, 0, 0});              // across an edge
    room.finish();
    std::vector<std::uint32_t> labels;
    for (std::uint32_t quad = 0; quad < 5; ++quad) {
        labels.insert(labels.end(), 2, quad);
    }
    const auto overlaps = find_layer_overlaps(room.scene_view(), labels);
    double with_floor = 0.0, with_neighbour = 0.0;
    for (const LayerOverlap& overlap : overlaps) {
        EXPECT_LT(overlap.first, overlap.second);
        EXPECT_NEAR(overlap.point.y, 0.0, 1e-7);
        if (labels[overlap.first] == 0) {
            EXPECT_EQ(labels[overlap.second], 1U);
            EXPECT_TRUE(overlap.point.x > 3.0 && overlap.point.x < 4.0);
            with_floor += overlap.area;
        } else {
            EXPECT_EQ(labels[overlap.first], 1U);
            EXPECT_EQ(labels[overlap.second], 2U);
            with_neighbour += overlap.area;
        }
    }
    EXPECT_NEAR(with_floor, 2.0, 1e-9);      // x 3 ... 4, z 1 ... 3
    EXPECT_NEAR(with_neighbour, 2.0, 1e-9);  // x 4 ... 5
    // One label on both claims nothing.
    EXPECT_TRUE(find_layer_overlaps(room.scene_view(), std::vector<std::uint32_t>(10, 3)).empty());
}

}  // namespace
}  // namespace earshot::frustum
