// SPDX-License-Identifier: MIT
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// The six walls of a 6 x 3 x 5 m box, two triangles each, with degenerate and duplicate triangles
/// strewn in; floor (triangles 1 and 2) of material 1, the rest of material 0.
Scene box_scene() {
    geometry::Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1 ? 6.0 : 0.0, i & 2 ? 3.0 : 0.0, i & 4 ? 5.0 : 0.0);
    }
    mesh.triangles = {{0, 0, 1},  // degenerate
                      {0, 4, 5},
                      {0, 5, 1},  // floor
                      {2, 3, 7},
                      {2, 7, 6},
                      {0, 1, 3},
                      {0, 3, 2},
                      {4, 6, 7},
                      {4, 7, 5},
                      {0, 2, 6},
                      {0, 6, 4},
                      {0, 2, 6},  // duplicate
                      {1, 5, 7},
                      {1, 7, 3}};
    Scene scene;
    scene.name = "box";
    scene.material_of_triangle.assign(mesh.triangles.size(), 0);
    scene.material_of_triangle[1] = scene.material_of_triangle[2] = 1;
    scene.materials.resize(2);
    scene.materials[0].name = "wall";
    scene.materials[0].absorption = EnergyCoefficient(0.19);
    scene.materials[1].name = "floor";
    scene.materials[1].absorption = EnergyCoefficient(0.36);
    scene.materials[1].scattering = EnergyCoefficient(0.75);
    scene.sources = {{.name = "s", .node = -1, .position = {1, 1, 1}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {4, 2, 3}}};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    return scene;
}

TEST(Simulator, DescribesDirectAndReflectedSound) {
    const Scene scene = box_scene();
    Simulator simulator(scene, {.specular_order = 1, .air_absorption = false});
    const auto pairs = simulator.run();
    ASSERT_EQ(pairs.size(), 1U);
    const auto& paths = pairs[0].paths;
    ASSERT_EQ(paths.size(), 7U);
    EXPECT_EQ(paths[0].kind, PathKind::direct);
    EXPECT_DOUBLE_EQ(paths[0].length, std::sqrt(14.0));
    EXPECT_DOUBLE_EQ(paths[0].delay, std::sqrt(14.0) / 343.2);
    EXPECT_DOUBLE_EQ(paths[0].pressure[3], 1.0 / std::sqrt(14.0));
    EXPECT_EQ(paths[0].pressure[10], 0.0);  // past the last octave
    int on_floor = 0;
    for (std::size_t i = 1; i < paths.size(); ++i) {
        const Path& path = paths[i];
        EXPECT_EQ(path.kind, PathKind::specular);
        EXPECT_GE(path.delay, paths[i - 1].delay);
        const bool floor = path.materials[0] == 1;
        on_floor += floor ? 1 : 0;
        EXPECT_EQ(path.triangles[0] == 1 || path.triangles[0] == 2, floor);
        EXPECT_NE(path.triangles[0], 11U);  // the duplicate takes no part
        // sqrt(1 - 0.19) = 0.9; sqrt((1 - 0.36) (1 - 0.75)) = 0.4
        EXPECT_NEAR(path.pressure[0] * path.length, floor ? 0.4 : 0.9, 1e-15);
        EXPECT_NEAR(glm::distance(path.points[0] + path.departure * glm::distance(path.points[0],
                                                                                  path.points[1]),
                                  path.points[1]),
                    0.0,
                    1e-12);
    }
    EXPECT_EQ(on_floor, 1);
    const auto& clean = simulator.geometry().clean;
    EXPECT_EQ(clean.degenerate_triangles, 1U);
    EXPECT_EQ(clean.duplicate_triangles, 1U);
    EXPECT_EQ(simulator.geometry().triangles, 12U);
    EXPECT_EQ(simulator.geometry().facets, 6U);
    EXPECT_EQ(simulator.statistics().paths, 7U);
}

TEST(Simulator, AirTakesItsShare) {
    const Scene scene = box_scene();
    const Air air = {.temperature_c = 5.0, .humidity_percent = 20.0};
    const auto with = Simulator(scene, {.specular_order = 1, .air = air}).run();
    const auto without =
        Simulator(scene, {.specular_order = 1, .air = air, .air_absorption = false}).run();
    const auto& bands = audio::Bands::octaves();
    for (std::size_t i = 0; i < with[0].paths.size(); ++i) {
        const Path& path = with[0].paths[i];
        EXPECT_DOUBLE_EQ(path.delay * speed_of_sound(air), path.length);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            const double loss_db =
                absorption_db_per_metre(air, bands.exact_hz()[band]) * path.length;
            EXPECT_NEAR(path.pressure[band] / without[0].paths[i].pressure[band],
                        std::pow(10.0, -loss_db / 20.0),
                        1e-12);
        }
    }
}

TEST(Simulator, OneSidedMaterialsReflectOnTheirFront) {
    Scene scene = box_scene();  // fronts face inside, by the order of the corners
    scene.materials[0].one_sided = scene.materials[1].one_sided = true;
    const auto inside = Simulator(scene, {.specular_order = 1}).run()[0].paths.size();
    scene = box_scene();
    const auto both = Simulator(scene, {.specular_order = 1}).run()[0].paths.size();
    EXPECT_EQ(both, 7U);
    EXPECT_TRUE(inside == 7U || inside == 1U);
    // Turned inside out, the other number.
    auto turned = box_scene();
    auto triangles = turned.mesh.triangles();
    for (auto& triangle : triangles) {
        std::swap(triangle[1], triangle[2]);
    }
    turned.mesh = geometry::AnimatedMesh::fixed(
        {.positions = turned.mesh.positions_at(0.0), .triangles = triangles});
    turned.materials[0].one_sided = turned.materials[1].one_sided = true;
    EXPECT_EQ(Simulator(turned, {.specular_order = 1}).run()[0].paths.size(), 8U - inside);
}

void expect_equal_arrivals(const Scene& scene, Options options) {
    Simulator with_paths(scene, options);
    options.report_paths = false;
    Simulator without(scene, options);
    const auto expected = with_paths.run();
    const auto found = without.run();
    EXPECT_EQ(without.statistics().paths, with_paths.statistics().paths);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_TRUE(found[i].paths.empty());
        const auto arrivals = arrivals_of(expected[i]);
        ASSERT_EQ(found[i].arrivals.size(), arrivals.size());
        for (std::size_t k = 0; k < arrivals.size(); ++k) {
            EXPECT_EQ(found[i].arrivals[k].delay, arrivals[k].delay);
            EXPECT_EQ(found[i].arrivals[k].pressure, arrivals[k].pressure);
            EXPECT_EQ(found[i].arrivals[k].direction, arrivals[k].direction);
            EXPECT_EQ(found[i].arrivals[k].is_inverted, arrivals[k].is_inverted);
        }
    }
}

TEST(Simulator, ArrivalsWithoutPathsAreThoseOfThePaths) {
    Scene scene = box_scene();
    scene.listeners.push_back({.name = "m", .node = -1, .position = {4, 1.5, 2.5}});
    expect_equal_arrivals(scene, {.specular_order = 6});
    expect_equal_arrivals(scene, {.specular_order = 5, .min_level_db = -30.0});
    expect_equal_arrivals(scene, {.specular_order = 5, .air_absorption = false});
    scene.materials[1] = scene.materials[0];
    expect_equal_arrivals(scene, {.specular_order = 5});
    // Frusta, and what needs whole paths.
    expect_equal_arrivals(scene, {.specular_order = 3, .box_lattice = false});
    scene.sources[0].directivity = Directivity::first_order(0.5);
    expect_equal_arrivals(scene, {.specular_order = 3});
    scene.sources[0].directivity = {};
    scene.sources[0].position = {2, 0, 3};  // on the floor
    scene.listeners.push_back({.name = "out", .node = -1, .position = {7, 1, 1}});
    expect_equal_arrivals(scene, {.specular_order = 3});
}

TEST(Simulator, ReportsWhileItTracesAndWhileRaysRun) {
    class Reports : public Progress {
    public:
        void report(std::string_view stage, std::size_t done, std::size_t total) override {
            lines.emplace_back(stage, done, total);
        }
        std::vector<std::tuple<std::string, std::size_t, std::size_t>> lines;
    };
    Scene scene = box_scene();
    scene.sources.push_back(scene.sources.front());
    Simulator simulator(
        scene, {.specular_order = 4, .box_lattice = false, .rays = 3000, .late_length = 0.1});
    Reports reports;
    const auto told = simulator.run(Executor::serial(), &reports);
    // Tracing comes first, subtree by subtree of the beam trees.
    using Lines = decltype(reports.lines);
    const auto late = std::find_if(reports.lines.begin(),
                                   reports.lines.end(),
                                   [](const auto& line) { return std::get<0>(line) != "tracing"; });
    const Lines tracing(reports.lines.begin(), late);
    ASSERT_GE(tracing.size(), 4U);
    double fraction = 0.0;
    for (const auto& [stage, done, total] : tracing) {
        const double next = static_cast<double>(done) / static_cast<double>(total);
        EXPECT_GE(next, fraction);
        fraction = next;
    }
    EXPECT_EQ(fraction, 1.0);
    EXPECT_EQ(Lines(late, reports.lines.end()),
              (Lines{{"late rays", 0, 6000},
                     {"late rays", 750, 6000},
                     {"late rays", 1500, 6000},
                     {"late rays", 2250, 6000},
                     {"late rays", 3000, 6000},
                     {"late rays", 3000, 6000},
                     {"late rays", 3750, 6000},
                     {"late rays", 4500, 6000},
                     {"late rays", 5250, 6000},
                     {"late rays", 6000, 6000}}));
    const auto untold = simulator.run();
    ASSERT_EQ(told.size(), untold.size());
    EXPECT_EQ(told[1].late.energy, untold[1].late.energy);
}

TEST(Simulator, NoDirectSoundAtTheSourceItself) {
    Scene scene = box_scene();
    scene.listeners[0].position = scene.sources[0].position;
    const auto paths = Simulator(scene, {.specular_order = 1}).run()[0].paths;
    ASSERT_EQ(paths.size(), 6U);
    EXPECT_TRUE(std::isfinite(paths[0].pressure[0]));
}

TEST(Simulator, TimesMayBeVisitedInAnyOrder) {
    // A wall that slides between source and listener and away again.
    geometry::Mesh wall{{{0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5}}, {{0, 1, 2}, {0, 2, 3}}};
    geometry::Node node;
    node.translation = {.interpolation = geometry::Interpolation::linear,
                        .times = {0.0, 1.0, 2.0},
                        .values = {0, 20, 0, 0, 0, 0, 0, -20, 0}};
    geometry::Part part;
    part.node = 0;
    part.positions = wall.positions;
    Scene scene;
    scene.mesh = geometry::AnimatedMesh({node}, {}, {part}, wall.triangles);
    scene.materials.resize(1);
    scene.material_of_triangle = {0, 0};
    scene.sources = {{.name = "s", .node = -1, .position = {-3, 0, 0}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {3, 1, 0}},
                       {.name = "m", .node = 0, .position = {3, 1, 0}}};
    Simulator simulator(scene, {.specular_order = 1});
    const auto paths_at = [&](double time) {
        simulator.set_time(time);
        return simulator.run()[0].paths.size();
    };
    EXPECT_EQ(paths_at(0.0), 1U);
    EXPECT_EQ(paths_at(1.0), 0U);
    EXPECT_EQ(paths_at(2.0), 1U);
    EXPECT_EQ(paths_at(1.0), 0U);
    EXPECT_EQ(paths_at(0.0), 1U);
}

TEST(Simulator, AnInstantWithoutTrianglesIsRefusedEveryTimeAndLeavesTheOneBefore) {
    // A wall that shrinks to a point at 1 s, and is somewhere else at 2 s.
    geometry::Node node;
    node.scale = {.interpolation = geometry::Interpolation::linear,
                  .times = {0.0, 1.0, 2.0},
                  .values = {1, 1, 1, 0, 0, 0, 1, 1, 1}};
    node.translation = {.interpolation = geometry::Interpolation::linear,
                        .times = {0.0, 1.0, 2.0},
                        .values = {0, 0, 0, 0, 0, 0, 0, 20, 0}};
    geometry::Part part;
    part.node = 0;
    part.positions = {{0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5}};
    Scene scene;
    scene.mesh = geometry::AnimatedMesh({node}, {}, {part}, {{0, 1, 2}, {0, 2, 3}});
    scene.materials.resize(1);
    scene.material_of_triangle = {0, 0};
    scene.sources = {{.name = "s", .node = -1, .position = {-3, 0, 0}}};
    scene.listeners = {{.name = "l", .node = -1, .position = {3, 1, 0}},
                       {.name = "m", .node = -1, .position = {-3, 1, 0}}};
    Simulator simulator(scene, {.specular_order = 1});
    const auto paths_of = [&](std::size_t pair) { return simulator.run()[pair].paths.size(); };
    ASSERT_EQ(paths_of(0), 0U);
    ASSERT_EQ(paths_of(1), 2U);
    for (int i = 0; i < 2; ++i) {
        EXPECT_THROW(simulator.set_time(1.0), Error);
        EXPECT_EQ(paths_of(0), 0U);
        EXPECT_EQ(paths_of(1), 2U);
    }
    simulator.set_time(2.0);
    EXPECT_EQ(paths_of(0), 1U);
    EXPECT_EQ(paths_of(1), 1U);
    simulator.set_time(0.0);
    EXPECT_EQ(paths_of(0), 0U);
}

/// The box with a corner that moves, and a screen that comes between source and listener.
Scene deforming_scene() {
    Scene scene = box_scene();
    geometry::Part part;
    part.positions = scene.mesh.positions_at(0.0);
    std::vector<geometry::Triangle> triangles = scene.mesh.triangles();
    const auto first = static_cast<geometry::VertexId>(part.positions.size());
    part.positions.insert(part.positions.end(), {{2, 0.5, 4}, {3, 0.5, 4}, {2.5, 2.5, 4}});
    triangles.push_back({first, first + 1, first + 2});
    scene.material_of_triangle.push_back(0);
    part.targets.push_back({std::vector<Vec3>(part.positions.size(), Vec3(0.0))});
    part.targets[0].displacement[7] = {0.5, 0.25, 0.5};
    for (std::size_t i = 0; i < 3; ++i) {
        part.targets[0].displacement[first + i] = {0.0, 0.0, -4.0};
    }
    part.rest_weights = {0.0};
    part.weights = {.times = {0.0, 1.0}, .values = {0.0, 1.0}};
    std::vector<geometry::Part> parts = {part};
    scene.mesh = geometry::AnimatedMesh({}, {}, std::move(parts), std::move(triangles));
    return scene;
}

TEST(Simulator, BuildsOneHierarchyOverTheTrianglesOfAnAnimation) {
    const Scene scene = deforming_scene();
    Simulator simulator(scene, {.specular_order = 2, .rays = 500});
    simulator.run();
    EXPECT_EQ(simulator.hierarchy_statistics().triangle_builds, 1U);
    EXPECT_EQ(simulator.hierarchy_statistics().facet_builds, 1U);
    EXPECT_EQ(simulator.hierarchy_statistics().updates, bvh::UpdateStatistics{});
    for (const double time : {0.25, 0.5, 0.75}) {
        simulator.set_time(time);
        simulator.run();
    }
    // The corner that moves bends three walls, once.
    const HierarchyStatistics statistics = simulator.hierarchy_statistics();
    EXPECT_EQ(statistics.triangle_builds, 1U);
    EXPECT_EQ(statistics.facet_builds, 2U);
    const bvh::UpdateStatistics& updates = statistics.updates;
    EXPECT_EQ(updates.refits + updates.repairs + updates.rebuilds, 3U + 2U);
}

TEST(Simulator, DirectSoundAloneIsThatOfASearchWithReflections) {
    Scene scene = deforming_scene();
    scene.listeners.push_back({.name = "on the floor", .node = -1, .position = {3, 0, 2}});
    for (const std::size_t listeners : {2U, 1U}) {
        scene.listeners.resize(listeners);  // then none lies on a surface
        Simulator direct(scene, {.specular_order = 0});
        Simulator all(scene, {.specular_order = 1});
        std::size_t found = 0, frames = 0;
        for (const double time : {0.0, 0.2, 0.4, 0.5, 0.6, 1.0, 0.3}) {
            direct.set_time(time);
            all.set_time(time);
            const auto pairs = direct.run();
            const auto expected = all.run();
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                auto paths = expected[i].paths;
                std::erase_if(paths, [](const Path& path) { return path.order > 0; });
                ASSERT_EQ(pairs[i].paths.size(), paths.size()) << time;
                for (std::size_t k = 0; k < paths.size(); ++k) {
                    EXPECT_EQ(pairs[i].paths[k].points, paths[k].points);
                    EXPECT_EQ(pairs[i].paths[k].pressure, paths[k].pressure);
                }
                found += paths.size();
            }
            frames += pairs.size();
            EXPECT_EQ(direct.geometry().facets, all.geometry().facets);
            EXPECT_EQ(direct.geometry().clean, all.geometry().clean);
        }
        EXPECT_GT(found, 0U);
        EXPECT_LT(found, frames);  // the screen blocks some
    }
}

TEST(Simulator, RefusesWhatCannotBeSimulated) {
    const Scene scene = box_scene();
    EXPECT_THROW(Simulator(scene, {.air = {.humidity_percent = 101.0}}), Error);
    EXPECT_THROW(Simulator(scene, {.specular_order = -1}).run(), Error);
    Scene flat = box_scene();
    flat.mesh = geometry::AnimatedMesh::fixed(
        {.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}});
    flat.material_of_triangle = {0};
    EXPECT_THROW(Simulator{flat}, Error);
}

TEST(ArrivalsOf, CarryDelayPressureAndDirection) {
    const Scene scene = box_scene();
    const auto pair = Simulator(scene, {.specular_order = 1}).run()[0];
    const auto arrivals = arrivals_of(pair);
    ASSERT_EQ(arrivals.size(), pair.paths.size());
    EXPECT_EQ(arrivals[2].delay, pair.paths[2].delay);
    EXPECT_EQ(arrivals[2].pressure, pair.paths[2].pressure);
    EXPECT_EQ(arrivals[2].direction[1], pair.paths[2].arrival.y);
}

void expect_same(const std::vector<PairResult>& a, const std::vector<PairResult>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].paths.size(), b[i].paths.size());
        for (std::size_t k = 0; k < a[i].paths.size(); ++k) {
            EXPECT_EQ(a[i].paths[k].points, b[i].paths[k].points);
            EXPECT_EQ(a[i].paths[k].pressure, b[i].paths[k].pressure);
            EXPECT_EQ(a[i].paths[k].triangles, b[i].paths[k].triangles);
        }
    }
}

TEST(Simulator, KeptTracesFollowSourcesAndListenersThatMove) {
    Scene scene = box_scene();
    scene.sources.push_back({.name = "t", .position = {5, 1, 2}});
    Simulator keeping(scene, {.specular_order = 3, .keep_traces = true});
    for (int step = 0; step < 6; ++step) {
        if (step % 2 == 1) {
            scene.listeners[0].position.x -= 0.3;
        }
        if (step % 3 == 2) {
            scene.sources[1].position.z += 0.4;
        }
        Simulator fresh(scene, {.specular_order = 3});
        expect_same(keeping.run(), fresh.run());
    }
    scene.listeners[0].position = {100.0, 50.0, 20.0};  // farther than what was expected
    Simulator fresh(scene, {.specular_order = 3});
    expect_same(keeping.run(), fresh.run());
}

TEST(Simulator, SoundGoesThroughMaterialsThatTransmitIfAskedFor) {
    Scene scene = box_scene();
    scene.materials[0].transmission = EnergyCoefficient(0.04);
    scene.listeners[0].position = {9.0, 2.0, 3.0};  // beyond the wall x = 6
    EXPECT_TRUE(Simulator(scene, {.specular_order = 2}).run()[0].paths.empty());
    const auto pairs =
        Simulator(scene, {.specular_order = 2, .air_absorption = false, .transmission = true})
            .run();
    const auto& paths = pairs[0].paths;
    // Straight, and over the floor and the walls z = 0 and x = 0; over the others the reflection
    // would lie beyond the wall that is passed.
    ASSERT_EQ(paths.size(), 1U + 3U);
    EXPECT_EQ(paths[0].kind, PathKind::transmitted);
    EXPECT_EQ(name_of(paths[0].kind), "transmitted");
    EXPECT_EQ(paths[0].order, 1);
    EXPECT_NEAR(paths[0].pressure[4] * paths[0].length, 0.2, 1e-15);
    EXPECT_NEAR(paths[0].points[1].x, 6.0, 1e-12);
    for (std::size_t i = 1; i < paths.size(); ++i) {
        EXPECT_EQ(paths[i].order, 2);
        EXPECT_EQ(paths[i].kind, PathKind::transmitted);
    }
}

TEST(Simulator, LevelAndLengthLimitsLeaveOutExactlyWhatFallsUnderThem) {
    const Scene scene = box_scene();
    const auto all = Simulator(scene, {.specular_order = 3}).run()[0].paths;
    const Path& some = all[all.size() / 2];
    const auto loudest = [](const Path& path) {
        return *std::max_element(path.pressure.begin(), path.pressure.end());
    };
    const double level = 20.0 * std::log10(loudest(some));
    std::size_t loud = 0, near = 0;
    for (const Path& path : all) {
        loud += 20.0 * std::log10(loudest(path)) >= level - 1e-9 ? 1 : 0;
        near += path.length <= some.length ? 1 : 0;
    }
    EXPECT_LT(loud, all.size());
    const auto count = [&](const Options& options) {
        return Simulator(scene, options).run()[0].paths.size();
    };
    EXPECT_EQ(count({.specular_order = 3, .min_level_db = level - 1e-9}), loud);
    EXPECT_EQ(count({.specular_order = 3, .max_length = some.length}), near);
    EXPECT_EQ(count({.specular_order = 3}), all.size());
}

/// Of the box scene, as if all of it, or all but the floor, were seen from x <= 3.
visibility::VisibleSets sets_of(const Scene& scene, bool sees_floor) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(0.0);
    std::vector<visibility::ObjectId> seen;
    for (visibility::ObjectId triangle = 0; triangle < 14; ++triangle) {
        if (sees_floor || (triangle != 1 && triangle != 2)) {
            seen.push_back(triangle);
        }
    }
    return {visibility::ViewCells(visibility::ViewRegion{{0.0, 0.0, 0.0}, {3.0, 3.0, 5.0}}),
            visibility::Objects::triangles(14),
            {seen},
            {.scene = "box",
             .mesh_digest = visibility::mesh_digest({positions, scene.mesh.triangles()})}};
}

TEST(Simulator, VisibleSetsLeaveOutWhatTheSourcesCellDoesNotSee) {
    Scene scene = box_scene();
    const auto paths_with = [&](const visibility::VisibleSets* sets) {
        return Simulator(scene, {.specular_order = 2, .visible_sets = sets}).run()[0].paths;
    };
    const auto all = paths_with(nullptr);
    const auto complete = sets_of(scene, true);
    const auto without_floor = sets_of(scene, false);
    EXPECT_EQ(paths_with(&complete).size(), all.size());
    const auto begins_at_floor = [](const Path& path) {
        return path.order > 0 && path.materials[0] == 1;
    };
    const auto lost = std::count_if(all.begin(), all.end(), begins_at_floor);
    const auto some = paths_with(&without_floor);
    EXPECT_EQ(some.size() + static_cast<std::size_t>(lost), all.size());
    EXPECT_EQ(std::count_if(some.begin(), some.end(), begins_at_floor), 0);
    EXPECT_GT(lost, 2);
    // From outside of the cells nothing is left out.
    scene.sources[0].position.x = 3.5;
    EXPECT_EQ(paths_with(&without_floor).size(), paths_with(nullptr).size());
}

TEST(Simulator, RefusesVisibleSetsOfAnotherMesh) {
    const Scene scene = box_scene();
    const auto sets = sets_of(scene, true);
    Scene other = box_scene();
    geometry::Mesh mesh = {scene.mesh.positions_at(0.0),
                           {scene.mesh.triangles().begin(), scene.mesh.triangles().end()}};
    mesh.positions[7].x += 0.001;
    other.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    Simulator simulator(other, {.visible_sets = &sets});
    EXPECT_THROW(simulator.run(), Error);
}

TEST(Simulator, APointOnASurfaceIsTheLimitFromInside) {
    Scene scene = box_scene();
    scene.sources[0].position = {1, 0, 1};
    Simulator simulator(scene, {.specular_order = 2, .rays = 2000, .late_length = 0.2});
    const auto on_floor = simulator.run();
    scene.sources[0].position = {1, 1e-4, 1};
    Simulator above_floor(scene, {.specular_order = 2, .rays = 2000, .late_length = 0.2});
    const auto above = above_floor.run();
    ASSERT_EQ(on_floor[0].paths.size(), 25U);
    ASSERT_EQ(above[0].paths.size(), 25U);
    for (std::size_t i = 0; i < 25; ++i) {
        const Path& path = on_floor[0].paths[i];
        EXPECT_NEAR(path.length, above[0].paths[i].length, 1e-3);
        EXPECT_EQ(path.points.front(), Vec3(1, 0, 1));
        EXPECT_EQ(path.points.back(), Vec3(4, 2, 3));
        EXPECT_NEAR(glm::length(path.departure), 1.0, 1e-9);
    }
    // Direct sound and its reflection from the floor leave upwards and downwards.
    EXPECT_GT(on_floor[0].paths[0].departure.y, 0.1);
    EXPECT_LT(on_floor[0].paths[1].departure.y, -0.1);
    // All rays begin in the room.
    EXPECT_NEAR(on_floor[0].visible_volume, above[0].visible_volume, 1.0);
}

TEST(Simulator, RefusesPointsWhoseSideOfASurfaceIsNotKnown) {
    Scene scene = box_scene();
    scene.sources[0].position = {1, 0, 1};
    scene.listeners[0].position = {4, 0, 3};
    Simulator simulator(scene, {.specular_order = 1});
    try {
        simulator.run();
        FAIL() << "both lie on the floor";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), "source s");
        // As the file numbers them: triangle 0 is degenerate, 1 and 2 are the floor.
        EXPECT_NE(error.line().find("lies on triangle 1, and listener l"), std::string::npos)
            << error.line();
    }
}

TEST(Simulator, WarnsOfPlacesThatTwoMaterialsClaim) {
    EXPECT_TRUE(Simulator(box_scene()).warnings().empty());  // its duplicate is of one material
    Scene scene = box_scene();
    geometry::Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    // A poster of 2 m2 on the wall z = 0, of which a half hangs over the edge of the wall.
    mesh.positions.insert(mesh.positions.end(), {{5, 1, 0}, {7, 1, 0}, {7, 2, 0}, {5, 2, 0}});
    mesh.triangles.push_back({8, 9, 10});
    mesh.triangles.push_back({8, 10, 11});
    mesh.triangles.push_back({2, 7, 3});  // a half of the ceiling once more
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.material_of_triangle.insert(scene.material_of_triangle.end(), {2, 2, 1});
    scene.materials.push_back({.name = "poster"});
    const Warnings warnings = Simulator(scene).warnings();
    ASSERT_EQ(warnings.size(), 2U);
    EXPECT_EQ(warnings[0].subject, "box");
    EXPECT_NE(warnings[0].what.find("wall and floor"), std::string::npos) << warnings[0].what;
    EXPECT_NE(warnings[0].what.find(" 15 m2"), std::string::npos) << warnings[0].what;
    EXPECT_NE(warnings[1].what.find("wall and poster"), std::string::npos) << warnings[1].what;
    EXPECT_NE(warnings[1].what.find(" 1 m2"), std::string::npos) << warnings[1].what;
}

}  // namespace
}  // namespace earshot::propagation
