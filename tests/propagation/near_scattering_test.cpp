// SPDX-License-Identifier: MIT
// Sound that surfaces near a listener scatter to it, which reversed rays find.
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "late_sound_near_surfaces.h"
#include "one_material_scene.h"
#include <cmath>
#include <functional>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

// Source and listener may be exchanged (reciprocity), and a source near a surface needs no care.
void compare_with_exchanged_runs(const std::vector<double>& distances,
                                 double scattering,
                                 std::size_t rays) {
    constexpr double kLength = 0.8, kFine = 0.005;
    const OneMaterialScene room(box_mesh(kRoom), 0.2, scattering);
    const std::vector<Place> all = places(distances);
    const LateEnergy late = traced(room, kSource, positions(all), rays, 0, kLength, kFine);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const LateEnergy exchanged =
            traced(room, all[k].position, {kSource}, rays, 0, kLength, kFine);
        const std::vector<double> found = energies_of(late.listeners[k]);
        const std::vector<double> expected = energies_of(exchanged.listeners[0]);
        const auto name = all[k].name + ", scattering " + std::to_string(scattering);
        EXPECT_NEAR(sum_of(late.listeners[k]) / sum_of(exchanged.listeners[0]), 1.0, 0.01) << name;
        EXPECT_NEAR(decay_time(found, kFine) / decay_time(expected, kFine), 1.0, 0.01) << name;
    }
}

TEST(NearScattering, EnergyAndDecayAreThoseOfExchangedRuns) {
    compare_with_exchanged_runs({0.001}, 0.3, 60000);
    compare_with_exchanged_runs({0.001}, 1.0, 30000);
}

TEST(SlowNearScattering, EnergyAndDecayAreThoseOfExchangedRunsAtAnyDistance) {
    const std::vector<double> distances = {0.3, 0.1, 0.03, 0.01, 0.003, 0.0001};
    compare_with_exchanged_runs(distances, 0.3, 100000);
    compare_with_exchanged_runs(distances, 1.0, 40000);
}

/// Energy at a listener above the plane y = 0 that scatters everything, the irradiance of which is
/// known: the integral of irradiance / pi over the directions in which the listener looks down.
double plane_energy(const Vec3& listener, const std::function<double(const Vec3&)>& irradiance) {
    constexpr int kRings = 4000, kSectors = 256;
    constexpr double kHalfWidth = 30.0;
    double energy = 0.0;
    for (int ring = 0; ring < kRings; ++ring) {
        // Equal steps of the cosine are equal solid angles of the listener.
        const double cosine = 1.0 - (ring + 0.5) / kRings;
        const double radius = listener.y * std::sqrt(1.0 - cosine * cosine) / cosine;
        for (int sector = 0; sector < kSectors; ++sector) {
            const double angle = 2.0 * kPi * (sector + 0.5) / kSectors;
            const Vec3 point(
                listener.x + radius * std::cos(angle), 0.0, listener.z + radius * std::sin(angle));
            if (std::max(std::abs(point.x), std::abs(point.z)) < kHalfWidth) {
                energy += 2.0 * irradiance(point) / (kRings * kSectors);
            }
        }
    }
    return energy;
}

double irradiance_from(const Vec3& source, const Vec3& point) {
    const double distance = glm::distance(source, point);
    return source.y / (distance * distance * distance);
}

// In open air: the energy just above the plane is twice its irradiance.
TEST(NearScattering, APlaneIsAsBrightFromNearAsItsIrradiance) {
    const OneMaterialScene scene(wide_plane(), 0.0, 1.0);
    const Vec3 source(0.0, 5.0, 0.0);
    std::vector<Vec3> listeners;
    for (const double height : {1.0, 0.3, 0.1, 0.03, 0.005, 0.0001}) {
        listeners.emplace_back(1.0, height, 0.5);
    }
    const LateEnergy late = traced(scene, source, listeners, 100000, 0, 0.5);
    const double limit = 2.0 * irradiance_from(source, {1.0, 0.0, 0.5});
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        const double expected = plane_energy(
            listeners[k], [&](const Vec3& point) { return irradiance_from(source, point); });
        EXPECT_NEAR(sum_of(late.listeners[k]) / expected, 1.0, 0.01) << listeners[k].y;
        if (listeners[k].y < 0.01) {
            EXPECT_NEAR(sum_of(late.listeners[k]) / limit, 1.0, 0.01) << listeners[k].y;
        }
    }
}

// The direction in which the source radiates is that in which a reversed ray arrives.
TEST(NearScattering, ADirectionalSourceLightsThePlaneByItsPattern) {
    const OneMaterialScene scene(wide_plane(), 0.0, 1.0);
    const Vec3 position(0.0, 2.0, 0.0);
    RaySource source{.pose = {.position = position}, .directivity = Directivity::first_order(0.5)};
    for (const double height : {0.3, 0.001}) {
        const Vec3 listener(1.0, height, 0.5);
        const RayOptions options = {
            .rays = 60000, .length = 0.3, .specular_order = 0, .air_absorption = false};
        const LateEnergy late =
            trace_late_rays(scene.scene(), source, std::vector<Vec3>{listener}, options);
        const double expected = plane_energy(listener, [&](const Vec3& point) {
            const Vec3 direction = glm::normalize(point - position);
            const double pressure =
                source.directivity.pressure(options.bands, source.pose.seen_from(direction))[kBand];
            return pressure * pressure * irradiance_from(position, point);
        });
        EXPECT_NEAR(sum_of(late.listeners[0]) / expected, 1.0, 0.01) << height;
    }
}

// Where both ends are near the point that scatters, neither rays from the one nor rays from the
// other have a bounded variance alone.
TEST(NearScattering, SourceAndListenerMayBothBeNear) {
    const OneMaterialScene scene(wide_plane(), 0.0, 1.0);
    for (const double height : {0.2, 0.02}) {
        const Vec3 source(0.0, height, 0.0), listener(0.3, 0.5 * height, 0.1);
        const LateEnergy late = traced(scene, source, {listener}, 200000, 0, 0.5);
        const double expected = plane_energy(
            listener, [&](const Vec3& point) { return irradiance_from(source, point); });
        EXPECT_NEAR(sum_of(late.listeners[0]) / expected, 1.0, 0.015) << height;
    }
}

/// The plane y = 0, which scatters everything, below a one-sided sheet at y = 1 that transmits.
struct SheetAbovePlane : OneMaterialScene {
    explicit SheetAbovePlane(bool front_is_up)
        : OneMaterialScene(mesh_with_sheet(front_is_up), 0, 1) {
        Material sheet;
        sheet.one_sided = true;
        sheet.absorption = EnergyCoefficient(0.5);
        sheet.scattering = EnergyCoefficient(0.5);
        sheet.transmission = EnergyCoefficient(0.36);
        materials.push_back(sheet);
        material_of_triangle = {0, 0, 1, 1};
    }

    static geometry::Mesh mesh_with_sheet(bool front_is_up) {
        geometry::Mesh mesh = wide_plane();
        for (int i = 0; i < 4; ++i) {
            mesh.positions.push_back(mesh.positions[static_cast<std::size_t>(i)] +
                                     Vec3(0.0, 1.0, 0.0));
        }
        if (front_is_up) {
            mesh.triangles.push_back({4, 5, 6});
            mesh.triangles.push_back({4, 6, 7});
        } else {
            mesh.triangles.push_back({4, 6, 5});
            mesh.triangles.push_back({4, 7, 6});
        }
        return mesh;
    }
};

// The back of a one-sided sheet absorbs: sound passes it from its front only, whichever way rays
// go. The way straight through is left to exact paths.
TEST(NearScattering, SoundPassesAOneSidedSheetFromItsFrontAlone) {
    const Vec3 source(0.0, 3.0, 0.0);
    for (const double height : {0.3, 0.001}) {
        const Vec3 listener(1.0, height, 0.5);
        const RayOptions options = {.rays = 100000,
                                    .length = 0.3,
                                    .specular_order = 1,
                                    .air_absorption = false,
                                    .transmission = true};
        for (const bool front_is_up : {true, false}) {
            const SheetAbovePlane scene(front_is_up);
            const LateEnergy late = trace_late_rays(scene.scene(),
                                                    {.pose = {.position = source}},
                                                    std::vector<Vec3>{listener},
                                                    options);
            const double expected = 0.36 * plane_energy(listener, [&](const Vec3& point) {
                                        return irradiance_from(source, point);
                                    });
            if (front_is_up) {
                EXPECT_NEAR(sum_of(late.listeners[0]) / expected, 1.0, 0.02) << height;
            } else {
                EXPECT_EQ(sum_of(late.listeners[0]), 0.0) << height;
            }
        }
    }
}

// Two rooms with a wall between them through which sound passes, the listener right behind it.
TEST(NearScattering, SoundThroughAWallIsThatOfTheExchangedRun) {
    geometry::Mesh mesh = box_mesh({6.0, 3.0, 4.0});
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    for (const Vec3& corner : {Vec3(3, 0, 0), Vec3(3, 3, 0), Vec3(3, 3, 4), Vec3(3, 0, 4)}) {
        mesh.positions.push_back(corner);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    OneMaterialScene rooms(mesh, 0.2, 0.3);
    rooms.materials.push_back(rooms.materials[0]);
    rooms.materials[1].absorption = EnergyCoefficient(0.6);
    rooms.materials[1].transmission = EnergyCoefficient(0.4);
    rooms.material_of_triangle[12] = rooms.material_of_triangle[13] = 1;
    const Vec3 source(1.2, 1.4, 1.1), listener(3.005, 1.7, 2.3);
    const auto energy = [&](const Vec3& from, const Vec3& to) {
        const RayOptions options = {.rays = 100000,
                                    .length = 0.4,
                                    .bin = kBin,
                                    .specular_order = 0,
                                    .air_absorption = false,
                                    .transmission = true};
        Executor executor(2);
        return sum_of(trace_late_rays(rooms.scene(),
                                      {.pose = {.position = from}},
                                      std::vector<Vec3>{to},
                                      options,
                                      executor)
                          .listeners[0]);
    };
    EXPECT_NEAR(energy(source, listener) / energy(listener, source), 1.0, 0.015);
}

}  // namespace
}  // namespace earshot::propagation
