// SPDX-License-Identifier: MIT
// Late sound at listeners near surfaces, where estimators that count rays in a sphere, or weigh
// points of surfaces with 1 / d^2, lose all accuracy.
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "late_sound_near_surfaces.h"
#include "one_material_scene.h"
#include <cmath>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

TEST(NearSurfaces, SpecularEnergyIsThatOfTheImagesAtAnyDistance) {
    constexpr int kOrder = 3;
    constexpr double kLength = 0.4;
    const OneMaterialScene room(box_mesh(kRoom), 0.1, 0.0);
    const std::vector<Place> all = places({0.3, 0.005, 0.0001});
    const LateEnergy late = traced(room, kSource, positions(all), 80000, kOrder, kLength);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::vector<double> expected =
            image_energies(kSource, all[k].position, 0.9, kOrder + 1, kLength, kBin);
        const audio::EnergyHistogram& histogram = late.listeners[k];
        double whole = 0.0;
        for (std::size_t n = 0; n < expected.size(); ++n) {
            whole += expected[n];
            if (expected[n] > 0.0) {
                const double error = histogram.error[n][kBand];
                EXPECT_NEAR(histogram.energy[n][kBand], expected[n], 5.0 * error + 1e-3 * whole)
                    << all[k].name << ", interval " << n;
            }
        }
        EXPECT_NEAR(sum_of(histogram) / whole, 1.0, 0.01) << all[k].name;
    }
}

TEST(SlowNearSurfaces, SpecularDecayTimeIsThatOfTheImagesAtAnyDistance) {
    constexpr double kLength = 1.8;
    const OneMaterialScene room(box_mesh(kRoom), 0.1, 0.0);
    const std::vector<Place> all = places({0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0001});
    const LateEnergy late = traced(room, kSource, positions(all), 600000, 0, kLength, 0.005);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::vector<double> expected =
            image_energies(kSource, all[k].position, 0.9, 1, kLength, 0.005);
        const std::vector<double> found = energies_of(late.listeners[k]);
        EXPECT_NEAR(late_energy(found, 0.005) / late_energy(expected, 0.005), 1.0, 0.01)
            << all[k].name;
        EXPECT_NEAR(decay_time(found, 0.005) / decay_time(expected, 0.005), 1.0, 0.01)
            << all[k].name;
    }
}

/// The sum of a histogram's energy in the direction of a point, and of all directions.
std::pair<double, double> energy_towards(const audio::EnergyHistogram& histogram,
                                         const Vec3& direction,
                                         std::size_t band) {
    const std::size_t part = audio::direction_part({direction.x, direction.y, direction.z});
    double from = 0.0, all = 0.0;
    for (const auto& span : histogram.directions) {
        for (std::size_t other = 0; other < audio::kDirectionParts; ++other) {
            all += span[other][band];
            from += other == part ? span[other][band] : 0.0;
        }
    }
    return {from, all};
}

// An image is heard at one instant and from one direction, in every band.
TEST(NearSurfaces, OneImageHasItsEnergyTimeAndDirection) {
    OneMaterialScene scene(wide_plane(), 0.0, 0.0);
    scene.materials[0].absorption = EnergyCoefficient({{31.5, 0.1}, {16000.0, 0.9}});
    const Vec3 source(0.0, 2.0, 0.0), image(0.0, -2.0, 0.0);
    for (const double height : {0.5, 0.001}) {
        const Vec3 listener(3.0, height, 0.4);
        const RayOptions options = {.rays = 200000,
                                    .length = 0.04,
                                    .bin = 1e-4,
                                    .specular_order = 0,
                                    .air_absorption = false,
                                    .report_directions = true};
        Executor executor(2);
        const LateEnergy late = trace_late_rays(scene.scene(),
                                                {.pose = {.position = source}},
                                                std::vector<Vec3>{listener},
                                                options,
                                                executor);
        const audio::EnergyHistogram& histogram = late.listeners[0];
        const double distance = glm::distance(image, listener);
        const auto instant = static_cast<std::size_t>(distance / kSpeed / options.bin);
        for (std::size_t band = 0; band < options.bands.count(); ++band) {
            const double absorption =
                scene.materials[0].absorption.at(options.bands.nominal_hz()[band]);
            const double expected = (1.0 - absorption) / (distance * distance);
            EXPECT_NEAR(histogram.energy[instant][band] / expected, 1.0, 0.03) << band;
            double all = 0.0;
            for (const audio::Spectrum& energy : histogram.energy) {
                all += energy[band];
            }
            EXPECT_EQ(all, histogram.energy[instant][band]) << band;
            const auto [from_image, from_all] = energy_towards(histogram, image - listener, band);
            EXPECT_NEAR(from_image / all, 1.0, 1e-12) << band;
            EXPECT_EQ(from_all, from_image) << band;
        }
    }
}

TEST(NearSurfaces, SoundThroughAWallHasTheEnergyOfTheExactPath) {
    OneMaterialScene scene(wide_plane(), 0.5, 0.0);
    scene.materials[0].transmission = EnergyCoefficient(0.36);
    const Vec3 source(0.0, 2.0, 0.0);
    for (const double depth : {1.5, 0.001}) {
        const Vec3 listener(1.0, -depth, 0.5);
        const RayOptions options = {.rays = 200000,
                                    .length = 0.04,
                                    .bin = 1e-3,
                                    .specular_order = 0,
                                    .air_absorption = false,
                                    .transmission = true};
        Executor executor(2);
        const LateEnergy late = trace_late_rays(scene.scene(),
                                                {.pose = {.position = source}},
                                                std::vector<Vec3>{listener},
                                                options,
                                                executor);
        const Vec3 apart = source - listener;
        EXPECT_NEAR(sum_of(late.listeners[0]) / (0.36 / glm::dot(apart, apart)), 1.0, 0.03)
            << depth;
    }
}

// Scattered sound of a surface just behind the listener comes from that side.
TEST(NearSurfaces, ScatteredSoundComesFromTheSurface) {
    const OneMaterialScene scene(wide_plane(), 0.0, 1.0);
    const RayOptions options = {.rays = 20000,
                                .length = 0.2,
                                .specular_order = 0,
                                .air_absorption = false,
                                .report_directions = true};
    Executor executor(2);
    const LateEnergy late = trace_late_rays(scene.scene(),
                                            {.pose = {.position = {0.0, 5.0, 0.0}}},
                                            std::vector<Vec3>{{1.0, 0.001, 0.5}},
                                            options,
                                            executor);
    double below = 0.0, all = 0.0;
    for (const auto& span : late.listeners[0].directions) {
        for (std::size_t part = 0; part < audio::kDirectionParts; ++part) {
            all += span[part][kBand];
            below += audio::middle_of_part(part)[1] < 0.0 ? span[part][kBand] : 0.0;
        }
    }
    EXPECT_NEAR(all, sum_of(late.listeners[0]), 1e-12 * all);
    EXPECT_NEAR(below / all, 1.0, 1e-12);
}

TEST(NearSurfaces, TheAnswerDoesNotJumpWhereASurfaceComesNear) {
    const OneMaterialScene room(box_mesh(kRoom), 0.1, 0.5);
    // On both sides of where near fields begin.
    const std::vector<Vec3> listeners = {{5.5, 3.5 - 0.76, 4.0}, {5.5, 3.5 - 0.74, 4.0}};
    const LateEnergy late = traced(room, kSource, listeners, 60000, 0, 0.4);
    EXPECT_NEAR(sum_of(late.listeners[0]) / sum_of(late.listeners[1]), 1.0, 0.015);
}

TEST(NearSurfaces, AListenersBytesDoNotDependOnOthers) {
    const OneMaterialScene room(box_mesh(kRoom), 0.1, 0.5);
    const std::vector<Vec3> all = positions(places({0.3, 0.005}));
    const LateEnergy together = traced(room, kSource, all, 3000, 0, 0.2);
    for (const std::size_t k : {std::size_t{0}, std::size_t{4}}) {
        const LateEnergy alone = traced(room, kSource, {all[k]}, 3000, 0, 0.2);
        EXPECT_EQ(alone.listeners[0].energy, together.listeners[k].energy);
        EXPECT_EQ(alone.listeners[0].error, together.listeners[k].error);
    }
}

}  // namespace
}  // namespace earshot::propagation
