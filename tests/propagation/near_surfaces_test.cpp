// SPDX-License-Identifier: MIT
// Late sound at listeners near surfaces, where estimators that count rays in a sphere, or weigh
// points of surfaces with 1 / d^2, lose all accuracy.
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "one_material_scene.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kPi = 3.141592653589793;
constexpr double kSpeed = 343.2;
constexpr std::size_t kBand = 5;  // 1 kHz
constexpr double kBin = 0.05;     // seconds

const Vec3 kRoom = {8.0, 3.5, 6.0};
const Vec3 kSource = {2.0, 1.5, 1.3};

struct Place {
    std::string name;
    Vec3 position;
};

/// Ever nearer to the ceiling, to an edge and to a corner.
std::vector<Place> places(const std::vector<double>& distances) {
    std::vector<Place> result;
    for (const double h : distances) {
        const std::string text = " at " + std::to_string(h);
        result.push_back({"wall" + text, {5.5, 3.5 - h, 4.0}});
        result.push_back({"edge" + text, {5.5, 3.5 - h, 6.0 - h}});
        result.push_back({"corner" + text, {8.0 - h, 3.5 - h, 6.0 - h}});
    }
    return result;
}

std::vector<Vec3> positions(const std::vector<Place>& places) {
    std::vector<Vec3> result;
    for (const Place& place : places) {
        result.push_back(place.position);
    }
    return result;
}

/// Energies of the images of kRoom from order `min_order` on, interval after interval.
std::vector<double> image_energies(
    const Vec3& source, const Vec3& listener, double reflected, int min_order, double length) {
    std::vector<double> energies(static_cast<std::size_t>(std::lround(length / kBin)));
    glm::ivec3 most;
    for (int axis = 0; axis < 3; ++axis) {
        most[axis] = static_cast<int>(kSpeed * length / kRoom[axis]) + 2;
    }
    for (int x = -most.x; x <= most.x; ++x) {
        for (int y = -most.y; y <= most.y; ++y) {
            for (int z = -most.z; z <= most.z; ++z) {
                const int n[3] = {x, y, z};
                Vec3 image;
                for (int k = 0; k < 3; ++k) {
                    image[k] = n[k] * kRoom[k] + (n[k] % 2 == 0 ? source[k] : kRoom[k] - source[k]);
                }
                const double distance = glm::distance(image, listener);
                const int order = std::abs(x) + std::abs(y) + std::abs(z);
                const auto interval = static_cast<std::size_t>(distance / kSpeed / kBin);
                if (order >= min_order && interval < energies.size()) {
                    energies[interval] += std::pow(reflected, order) / (distance * distance);
                }
            }
        }
    }
    return energies;
}

LateEnergy traced(const OneMaterialScene& scene,
                  const Vec3& source,
                  const std::vector<Vec3>& listeners,
                  std::size_t rays,
                  int order,
                  double length) {
    const RayOptions options = {.rays = rays,
                                .length = length,
                                .bin = kBin,
                                .specular_order = order,
                                .air_absorption = false};
    Executor executor(2);
    return trace_late_rays(
        scene.scene(), {.pose = {.position = source}}, listeners, options, executor);
}

double sum_of(const audio::EnergyHistogram& histogram) {
    double sum = 0.0;
    for (const audio::Spectrum& energy : histogram.energy) {
        sum += energy[kBand];
    }
    return sum;
}

TEST(NearSurfaces, SpecularEnergyIsThatOfTheImagesAtAnyDistance) {
    constexpr int kOrder = 3;
    constexpr double kLength = 0.4;
    const OneMaterialScene room(box_mesh(kRoom), 0.1, 0.0);
    const std::vector<Place> all = places({0.3, 0.005, 0.0001});
    const LateEnergy late = traced(room, kSource, positions(all), 80000, kOrder, kLength);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::vector<double> expected =
            image_energies(kSource, all[k].position, 0.9, kOrder + 1, kLength);
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

// Source and listener may be exchanged (reciprocity); a source near a surface needs no care.
TEST(NearSurfaces, ScatteredEnergyIsThatOfTheExchangedRun) {
    constexpr double kLength = 0.4;
    struct Case {
        double scattering;
        std::array<double, 3> tolerance;  // wall, edge, corner
    };
    // Where everything scatters, the irradiance of an edge and of a corner falls over distances
    // that are shorter than the disc it is averaged over, and than most wavelengths. The rest is
    // the spread of 60,000 and 40,000 rays: in a corner the ball holds an eighth of the rays.
    for (const Case& test : {Case{0.3, {0.01, 0.01, 0.02}}, Case{1.0, {0.01, 0.03, 0.1}}}) {
        const OneMaterialScene room(box_mesh(kRoom), 0.1, test.scattering);
        const std::vector<Place> all = places({0.3, 0.005, 0.0001});
        const LateEnergy late = traced(room, kSource, positions(all), 60000, 0, kLength);
        for (std::size_t k = 0; k < all.size(); ++k) {
            const LateEnergy exchanged =
                traced(room, all[k].position, {kSource}, 40000, 0, kLength);
            EXPECT_NEAR(sum_of(late.listeners[k]) / sum_of(exchanged.listeners[0]),
                        1.0,
                        test.tolerance[k % 3])
                << all[k].name << ", scattering " << test.scattering;
        }
    }
}

/// A plane at y = 0 through which sound may pass, 60 m wide.
geometry::Mesh wide_plane() {
    geometry::Mesh plane;
    plane.positions = {{-30, 0, -30}, {-30, 0, 30}, {30, 0, 30}, {30, 0, -30}};
    plane.triangles = {{0, 1, 2}, {0, 2, 3}};
    return plane;
}

// A plane that scatters everything, in open air: the energy just above it is twice its irradiance.
TEST(NearSurfaces, APlaneIsAsBrightFromNearAsItsIrradiance) {
    const OneMaterialScene scene(wide_plane(), 0.0, 1.0);
    const Vec3 source(0.0, 5.0, 0.0);
    const std::vector<double> heights = {1.0, 0.3, 0.005, 0.0001};
    std::vector<Vec3> listeners;
    for (const double h : heights) {
        listeners.emplace_back(1.0, h, 0.5);
    }
    const LateEnergy late = traced(scene, source, listeners, 100000, 0, 0.5);
    for (std::size_t k = 0; k < heights.size(); ++k) {
        // The integral of irradiance / pi over the directions in which the listener looks down.
        double expected = 0.0;
        constexpr int kRings = 2000, kSectors = 64;
        for (int ring = 0; ring < kRings; ++ring) {
            // Equal steps of the cosine are equal solid angles of the listener.
            const double cosine = 1.0 - (ring + 0.5) / kRings;
            const double reach = heights[k] * std::sqrt(1.0 - cosine * cosine) / cosine;
            for (int sector = 0; sector < kSectors; ++sector) {
                const double angle = 2.0 * kPi * (sector + 0.5) / kSectors;
                const Vec3 point(1.0 + reach * std::cos(angle), 0.0, 0.5 + reach * std::sin(angle));
                const bool is_on_plane = std::max(std::abs(point.x), std::abs(point.z)) < 30.0;
                const double distance = glm::distance(point, source);
                expected += is_on_plane ? 2.0 * source.y / (distance * distance * distance) /
                                              (kRings * kSectors)
                                        : 0.0;
            }
        }
        EXPECT_NEAR(sum_of(late.listeners[k]) / expected, 1.0, 0.02) << heights[k];
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
