// SPDX-License-Identifier: MIT
// Scenes that users stumbled over (tests/data/cases/acoustics), with the closed form of the box:
// image sources of walls that reflect sqrt(1 - absorption) of the pressure.
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/shoebox_images.h"
#include "support/test_paths.h"
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

const Vec3 kLower = {0.0, 0.0, 0.0};
const Vec3 kUpper = {8.0, 3.5, 6.0};
constexpr std::size_t kOneKilohertz = 5;  // of the octave bands from 31.5 Hz on

propagation::Scene load(const std::string& file) {
    return io::load_scene(test::source_file("tests/data/cases/acoustics/" + file)).scene;
}

struct Sums {
    std::size_t paths = 0;
    double pressure = 0.0;
    double pressure_squared = 0.0;
};

Sums expected_sums(const Vec3& source, const Vec3& listener, double absorption, int order) {
    Sums sums;
    for (const ShoeboxImage& image : shoebox_images(kLower, kUpper, source, listener, order)) {
        const double pressure = std::pow(std::sqrt(1.0 - absorption), image.order) / image.length;
        ++sums.paths;
        sums.pressure += pressure;
        sums.pressure_squared += pressure * pressure;
    }
    return sums;
}

Sums simulated_sums(const propagation::Scene& scene, int order) {
    propagation::Simulator simulator(scene, {.specular_order = order, .air_absorption = false});
    Sums sums;
    const propagation::PairResult pair = simulator.run().at(0);
    for (const propagation::Path& path : pair.paths) {
        const double pressure = path.pressure.at(kOneKilohertz);
        ++sums.paths;
        sums.pressure += pressure;
        sums.pressure_squared += pressure * pressure;
    }
    return sums;
}

void expect_sums(const propagation::Scene& scene,
                 const Vec3& source,
                 const Vec3& listener,
                 double absorption,
                 int order) {
    const Sums expected = expected_sums(source, listener, absorption, order);
    const Sums sums = simulated_sums(scene, order);
    EXPECT_EQ(sums.paths, expected.paths);
    EXPECT_NEAR(sums.pressure, expected.pressure, 1e-5);
    EXPECT_NEAR(sums.pressure_squared, expected.pressure_squared, 1e-5);
}

TEST(AcousticCases, ABoxStoredByTwoNodesSoundsAsOne) {
    const Vec3 source = {2.0, 1.2, 1.5};
    const Vec3 listener = {5.5, 1.6, 4.0};
    for (const char* file : {"one_node.gltf", "two_nodes.gltf"}) {
        const propagation::Scene scene = load(std::string("03-nearly-coincident-faces/") + file);
        expect_sums(scene, source, listener, 0.1, 3);
        expect_sums(scene, source, listener, 0.1, 4);
        const Sums sums = simulated_sums(scene, 4);
        EXPECT_EQ(sums.paths, 129U) << file;
        EXPECT_NEAR(sums.pressure_squared, 0.6988, 5e-5) << file;
    }
}

TEST(AcousticCases, TwoFloorsANanometreApartReflectOnce) {
    propagation::Scene scene = load("03-nearly-coincident-faces/floors.obj");
    scene.sources = {{.name = "s", .position = {-1.0, 1.0, 0.0}}};
    scene.listeners = {{.name = "l", .position = {1.5, 1.3, 0.2}}};
    EXPECT_EQ(simulated_sums(scene, 5).paths, 2U);
}

TEST(AcousticCases, PointsOnSurfacesHearTheWholeRoom) {
    const propagation::Scene room = load("04-point-on-a-surface/room.gltf");
    const Vec3 inside_source = {2.0, 1.2, 1.5};
    const Vec3 inside_listener = {5.5, 1.6, 4.0};
    const std::vector<std::pair<Vec3, Vec3>> pairs = {{{2.0, 0.0, 1.5}, inside_listener},
                                                      {inside_source, {5.5, 3.5, 4.0}},
                                                      {{2.0, 1e-12, 1.5}, inside_listener},
                                                      {{2.0, 1e-9, 1.5}, inside_listener},
                                                      {inside_source, {8.0, 1e-6, 6.0}}};
    for (const auto& [source, listener] : pairs) {
        propagation::Scene scene = room;
        scene.sources = {{.name = "s", .position = source}};
        scene.listeners = {{.name = "l", .position = listener}};
        expect_sums(scene, source, listener, 0.2, 2);
        expect_sums(scene, source, listener, 0.2, 3);
    }
    propagation::Scene scene = room;
    scene.sources = {{.name = "s", .position = pairs[0].first}};
    EXPECT_NEAR(simulated_sums(scene, 2).pressure, 2.5096, 5e-5);
}

TEST(AcousticCases, TheFirstOfCoplanarMaterialsCountsAndIsTold) {
    for (const auto& [file, first] :
         {std::pair("poster.obj", "marble"), std::pair("poster2.obj", "curtain-heavy")}) {
        propagation::Scene scene = load(std::string("17-coplanar-poster/") + file);
        scene.sources = {{.name = "s", .position = {2.0, 1.2, 1.5}}};
        scene.listeners = {{.name = "l", .position = {5.5, 1.6, 4.0}}};
        propagation::Simulator simulator(scene, {.specular_order = 1});
        const Warnings warnings = simulator.warnings();
        ASSERT_EQ(warnings.size(), 1U) << file;
        EXPECT_NE(warnings[0].what.find("1.2 m2"), std::string::npos) << warnings[0].what;
        EXPECT_NE(warnings[0].what.find(std::string(first) + " counts"), std::string::npos)
            << warnings[0].what;
        std::size_t on_the_wall = 0;
        const propagation::PairResult pair = simulator.run().at(0);
        for (const propagation::Path& path : pair.paths) {
            if (path.order == 1 && path.points[1].x == 0.0) {
                ++on_the_wall;
                EXPECT_EQ(scene.materials[path.materials[0]].name, first) << file;
            }
        }
        EXPECT_EQ(on_the_wall, 1U);
    }
}

}  // namespace
}  // namespace earshot::support
