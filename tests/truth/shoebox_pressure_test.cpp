// SPDX-License-Identifier: MIT
// Delays and band pressures in shoe-boxes against the closed form, and paths.json of one box cut
// into triangles in two ways.
#include "earshot/audio/bands.h"
#include "earshot/io/results.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/air.h"
#include "support/dice.h"
#include "support/rooms.h"
#include "support/shoebox_images.h"
#include <algorithm>
#include <cmath>

namespace earshot::support {
namespace {

using geometry::Vec3;

constexpr int kMaxOrder = 4;
constexpr int kPairsPerBox = 20;
const std::array<Vec3, 5> kSizes = {
    {{5.0, 2.6, 4.0}, {20.0, 2.5, 1.6}, {30.0, 14.0, 45.0}, {3.0, 3.0, 3.0}, {7.33, 3.01, 4.87}}};

/// The box with a material per wall, labels being walls.
propagation::Scene scene_of(const Room& room, const Vec3& source, const Vec3& listener) {
    propagation::Scene scene;
    scene.name = "box";
    for (int wall = 0; wall < 6; ++wall) {
        propagation::Material material;
        material.name = "wall" + std::to_string(wall);
        material.absorption = propagation::EnergyCoefficient(
            {{125.0, 0.05 + 0.1 * wall}, {1000.0, 0.1}, {4000.0, 0.6 - 0.1 * wall}});
        scene.materials.push_back(material);
    }
    scene.material_of_triangle = room.labels;
    scene.mesh = geometry::AnimatedMesh::fixed(room.mesh);
    scene.sources = {{.name = "s", .node = -1, .position = source}};
    scene.listeners = {{.name = "l", .node = -1, .position = listener}};
    return scene;
}

/// Per image in the order of delays: 1 / r, the walls' factors, and the air by the decibels per
/// metre, which tests/propagation/air_test.cpp holds against the standard.
void expect_closed_form(const propagation::Scene& scene,
                        const Vec3& size,
                        bool with_air,
                        const std::vector<propagation::Path>& paths) {
    auto images = shoebox_images(
        Vec3(0.0), size, scene.sources[0].position, scene.listeners[0].position, kMaxOrder);
    std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) {
        return a.length < b.length;
    });
    ASSERT_EQ(paths.size(), images.size());
    const auto& bands = audio::Bands::octaves();
    for (std::size_t i = 0; i < images.size(); ++i) {
        EXPECT_NEAR(paths[i].delay, images[i].length / 343.2, 1e-9);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            double pressure = 1.0 / images[i].length;
            for (std::size_t wall = 0; wall < 6; ++wall) {
                const double absorption =
                    scene.materials[wall].absorption.at(bands.nominal_hz()[band]);
                pressure *= std::pow(1.0 - absorption, 0.5 * images[i].bounces[wall]);
            }
            if (with_air) {
                const double loss_db = images[i].length * propagation::absorption_db_per_metre(
                                                              {}, bands.exact_hz()[band]);
                pressure *= std::pow(10.0, -loss_db / 20.0);
            }
            EXPECT_NEAR(paths[i].pressure[band], pressure, 1e-9 * pressure);
        }
    }
}

/// paths.json without the triangle numbers.
std::string text_without_triangles(const propagation::Scene& scene,
                                   const std::vector<propagation::PairResult>& pairs) {
    auto json = nlohmann::json::parse(io::encode_paths(
        {.scene = scene, .bands = audio::Bands::octaves(), .speed_of_sound = 343.2}, pairs));
    for (auto& path : json["pairs"][0]["paths"]) {
        path.erase("triangles");
    }
    return json.dump();
}

TEST(ShoeboxPressure, IsThatOfTheClosedFormHoweverTheWallsAreCut) {
    for (std::size_t box = 0; box < kSizes.size(); ++box) {
        const Vec3& size = kSizes[box];
        const Room plain = box_room(Vec3(0.0), size);
        const Room fine = tessellated_box_room(Vec3(0.0), size, 16);
        Dice dice(200 + box);
        for (int pair = 0; pair < kPairsPerBox; ++pair) {
            const Vec3 source = random_air_point(plain, dice);
            const Vec3 listener = random_air_point(plain, dice);
            const bool with_air = pair % 2 == 0;
            const propagation::Options options = {.specular_order = kMaxOrder,
                                                  .air_absorption = with_air};
            const auto scene = scene_of(plain, source, listener);
            const auto pairs = propagation::Simulator(scene, options).run();
            expect_closed_form(scene, size, with_air, pairs[0].paths);
            const auto fine_scene = scene_of(fine, source, listener);
            EXPECT_EQ(text_without_triangles(fine_scene,
                                             propagation::Simulator(fine_scene, options).run()),
                      text_without_triangles(scene, pairs))
                << "box " << box << ", pair " << pair;
        }
    }
}

}  // namespace
}  // namespace earshot::support
