// SPDX-License-Identifier: MIT
#include "earshot/io/scene_picture.h"

#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/label_checks.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace earshot::io {
namespace {

using propagation::PairResult;
using propagation::Scene;

Scene shipped(const std::string& name) {
    return load_scene(test::source_file("scenes") / (name + ".gltf")).scene;
}

std::vector<PairResult> first_order(const Scene& scene, const std::vector<double>& times) {
    propagation::Simulator simulator(scene, {.specular_order = 1});
    std::vector<PairResult> pairs;
    for (const double time : times) {
        simulator.set_time(time);
        for (PairResult& pair : simulator.run()) {
            pairs.push_back(std::move(pair));
        }
    }
    return pairs;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t result = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++result;
    }
    return result;
}

testing::AssertionResult is_labelled_well(const ScenePicture& picture) {
    if (auto result = test::labels_are_apart(picture.layout, picture.label_options.box_height);
        !result) {
        return result;
    }
    return test::boxes_clear_drawing(picture.layout, picture.image, picture.label_options);
}

// Neither lines that cross nor boxes that overlap, in plans and in isometric pictures, and a label
// for every source and listener.
TEST(ScenePicture, LabelsOfShippedScenesAreApart) {
    for (const char* name : {"shoebox",
                             "lroom",
                             "coupled_rooms",
                             "classroom",
                             "concert_hall",
                             "door",
                             "curtain",
                             "city"}) {
        const Scene scene = shipped(name);
        const std::vector<PairResult> pairs = first_order(scene, {0.0});
        const std::size_t marks = scene.sources.size() + scene.listeners.size();
        for (const Projection projection : {Projection::plan, Projection::isometric}) {
            const ScenePicture picture =
                ScenePictures(scene, {0.0}, pairs, {.projection = projection}).draw(0);
            EXPECT_TRUE(is_labelled_well(picture)) << name;
            ASSERT_GE(picture.layout.labels.size(), marks) << name;
            EXPECT_LE(picture.layout.labels.size(), marks + 6) << name;
            for (const auto& label : picture.layout.labels) {
                EXPECT_TRUE(label) << name;
            }
            EXPECT_EQ(count(picture.svg, "<text"), picture.layout.labels.size()) << name;
        }
    }
}

/// The sums of the steps of an anchor and of the middle of its object's area, in pixels.
struct Motion {
    double anchor_path = 0.0, object_path = 0.0;
};

// Over the animations: an anchor moves at most twice as far as the middle of its object's area, and
// what rests in the picture keeps its anchor.
TEST(ScenePicture, LabelsOfAnimationsMoveAtMostTwiceAsFarAsTheirObjects) {
    for (const auto& [name, projection] : {std::pair("door", Projection::plan),
                                           std::pair("door", Projection::isometric),
                                           std::pair("curtain", Projection::plan),
                                           std::pair("curtain", Projection::isometric)}) {
        const Scene scene = shipped(name);
        std::vector<double> times;
        for (int i = 0; i <= 25; ++i) {
            times.push_back(0.2 * i);
        }
        ScenePictures pictures(scene, times, first_order(scene, times), {.projection = projection});
        std::vector<Motion> motions;
        ScenePicture before;
        std::set<std::string> sizes;
        for (std::size_t frame = 0; frame < times.size(); ++frame) {
            ScenePicture picture = pictures.draw(frame);
            EXPECT_TRUE(is_labelled_well(picture)) << name << " " << frame;
            sizes.insert(picture.svg.substr(0, picture.svg.find('\n')));
            motions.resize(picture.objects.size());
            for (std::uint32_t object = 0; object < motions.size() && frame > 0; ++object) {
                const auto& now = picture.layout.labels[object];
                const auto& then = before.layout.labels[object];
                const bool both_float =
                    !picture.objects[object].anchor && !before.objects[object].anchor;
                if (now && then) {
                    motions[object].anchor_path += glm::distance(now->anchor, then->anchor);
                    motions[object].object_path +=
                        both_float ? glm::distance(test::middle_of(picture.image, object),
                                                   test::middle_of(before.image, object))
                                   : glm::distance(now->anchor, then->anchor);
                }
            }
            before = std::move(picture);
        }
        EXPECT_EQ(sizes.size(), 1U) << name;  // the paper keeps its size
        for (std::size_t object = 0; object < motions.size(); ++object) {
            const Motion& motion = motions[object];
            RecordProperty(
                std::string(name) + (projection == Projection::plan ? "_plan_" : "_isometric_") +
                    std::to_string(object),
                std::to_string(motion.anchor_path) + " of " + std::to_string(motion.object_path));
            EXPECT_LE(motion.anchor_path, 2.0 * motion.object_path) << name << " " << object;
            if (object < scene.sources.size() + scene.listeners.size()) {
                EXPECT_EQ(motion.anchor_path, 0.0) << name << " " << object;
            }
        }
    }
}

/// A room of 8 x 3 x 4 m with a table of 3 x 1 m, 1 m high.
Scene room_with_table() {
    geometry::Mesh mesh;
    Scene scene;
    scene.name = "room";
    scene.materials = {{.name = "floor"}, {.name = "wall"}, {.name = "ceiling"}, {.name = "table"}};
    const auto add = [&](const std::array<geometry::Vec3, 4>& corners, std::uint32_t material) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
        scene.material_of_triangle.insert(scene.material_of_triangle.end(), 2, material);
    };
    add({{{0, 0, 0}, {0, 0, 4}, {8, 0, 4}, {8, 0, 0}}}, 0);
    add({{{0, 3, 0}, {8, 3, 0}, {8, 3, 4}, {0, 3, 4}}}, 2);
    add({{{0, 0, 0}, {8, 0, 0}, {8, 3, 0}, {0, 3, 0}}}, 1);
    add({{{0, 0, 4}, {0, 3, 4}, {8, 3, 4}, {8, 0, 4}}}, 1);
    add({{{0, 0, 0}, {0, 3, 0}, {0, 3, 4}, {0, 0, 4}}}, 1);
    add({{{8, 0, 0}, {8, 0, 4}, {8, 3, 4}, {8, 3, 0}}}, 1);
    add({{{3, 1, 1.5}, {3, 1, 2.5}, {6, 1, 2.5}, {6, 1, 1.5}}}, 3);
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.sources = {{.name = "a < b", .position = {1.0, 1.5, 2.0}}};
    scene.listeners = {{.name = "seat", .position = {7.0, 1.2, 2.0}}};
    return scene;
}

TEST(ScenePicture, PlanShowsWhatLiesBelowItsCut) {
    const Scene scene = room_with_table();
    const std::vector<PairResult> pairs = first_order(scene, {0.0});
    const ScenePicture picture = ScenePictures(scene, {0.0}, pairs).draw(0);
    // 80 units per metre: 8 m are 640, 4 m 320, two units per pixel.
    EXPECT_EQ(picture.image.width, 320U);
    EXPECT_EQ(picture.image.height, 160U);
    const auto at = [&](double x, double z) {
        return picture.image
            .objects[static_cast<std::size_t>(z * 40.0) * 320 + static_cast<std::size_t>(x * 40.0)];
    };
    // Objects: the source, the listener, then the reflectors by the excess of their paths over the
    // direct 6.008 m: the table 0.03 m, the floor 0.57, the ceiling 0.84, the long walls 1.21 each,
    // and one of the two short walls with 2.00.
    ASSERT_EQ(picture.objects.size(), 2U + 6U);
    EXPECT_EQ(picture.objects[0].anchor, glm::dvec2(40.0, 80.0));
    EXPECT_EQ(picture.objects[1].anchor, glm::dvec2(280.0, 80.0));
    EXPECT_EQ(at(4.0, 2.0), 2U);
    EXPECT_FALSE(picture.objects[2].anchor);
    EXPECT_EQ(at(2.0, 3.0), 3U);
    EXPECT_EQ(at(4.0, 0.0), 5U);                    // walls are where the plan cuts them
    EXPECT_EQ(count(picture.svg, ">table +"), 2U);  // a title and a label
    EXPECT_EQ(count(picture.svg, ">ceiling +"), 2U);
    EXPECT_EQ(count(picture.svg, ">floor +1.7 ms<"), 2U);
    EXPECT_EQ(count(picture.svg, ">wall +"), 6U);
    EXPECT_EQ(count(picture.svg, ">a &lt; b<"), 2U);
    EXPECT_EQ(count(picture.svg, "<text"), 8U);
    EXPECT_TRUE(is_labelled_well(picture));
    // The ceiling is above the cut, so that its label points at its point of reflection, where the
    // path of 1.5 m up and 1.8 m down divides 6 m.
    ASSERT_TRUE(picture.objects[4].anchor);
    EXPECT_NEAR(picture.objects[4].anchor->x, 40.0 * (1.0 + 6.0 * 1.5 / 3.3), 1e-9);
    EXPECT_NEAR(picture.objects[4].anchor->y, 80.0, 1e-9);
}

TEST(ScenePicture, IsometricSeesThroughBacksAndMaterialsCanBeLeftOut) {
    const Scene scene = room_with_table();
    const std::vector<PairResult> pairs = first_order(scene, {0.0});
    ScenePictureOptions options{.projection = Projection::isometric,
                                .colours = {"#111", "#222", "#333", ""},
                                .max_reflectors = 2};
    const ScenePicture picture = ScenePictures(scene, {0.0}, pairs, options).draw(0);
    EXPECT_EQ(picture.objects.size(), 4U);
    EXPECT_EQ(count(picture.svg, "#111"), 1U);
    EXPECT_EQ(count(picture.svg, "#222"), 1U);
    EXPECT_EQ(count(picture.svg, "#333"), 0U);  // the ceiling shows its back
    EXPECT_EQ(count(picture.svg, "table"), 0U);
    EXPECT_TRUE(is_labelled_well(picture));
}

TEST(ScenePicture, IsTheSameForAnyNumberOfThreads) {
    const Scene scene = shipped("classroom");
    const std::vector<PairResult> pairs = first_order(scene, {0.0});
    Executor four(4);
    EXPECT_EQ(ScenePictures(scene, {0.0}, pairs).draw(0).svg,
              ScenePictures(scene, {0.0}, pairs, {}, four).draw(0, four).svg);
}

TEST(ScenePicture, LabelsAtMostSixtySourcesAndListeners) {
    Scene scene = room_with_table();
    for (int i = 1; i < 200; ++i) {
        scene.listeners.push_back(
            {.name = std::to_string(i), .position = {0.5 + 0.035 * i, 1.0, 3.5}});
    }
    const ScenePicture picture = ScenePictures(scene, {0.0}, {}).draw(0);
    EXPECT_EQ(count(picture.svg, "<text"), 60U);
    EXPECT_EQ(count(picture.svg, "r=\"5\""), 201U);
    EXPECT_TRUE(is_labelled_well(picture));
}

TEST(ScenePicture, NamesAreTextAndAreCut) {
    Scene scene = room_with_table();
    scene.name = "\x1b<room>";
    scene.sources[0].name = std::string(100, 'm');
    scene.listeners[0].name = "\xe5\xbb\xb3\x07";
    const ScenePicture picture = ScenePictures(scene, {0.0}, first_order(scene, {0.0})).draw(0);
    EXPECT_EQ(picture.svg.find('\x1b'), std::string::npos);
    EXPECT_EQ(picture.svg.find('\x07'), std::string::npos);
    EXPECT_EQ(count(picture.svg, std::string(36, 'm') + "\u2026"), 2U);
    EXPECT_EQ(count(picture.svg, std::string(37, 'm')), 0U);
}

}  // namespace
}  // namespace earshot::io
