// SPDX-License-Identifier: MIT
// Images that only a part of the ball about a listener sees.
#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "late_sound_near_surfaces.h"
#include "one_material_scene.h"
#include <cmath>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// A mirror in the plane y = 0 that ends at some x, in open air.
geometry::Mesh mirror_up_to(double x) {
    geometry::Mesh mesh;
    mesh.positions = {{-30, 0, -30}, {-30, 0, 30}, {x, 0, 30}, {x, 0, -30}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// The image of the source is visible to points on one side of a plane through its edge. The
// listener has the whole energy of it, or none.
TEST(ImageVisibility, AMirrorThatEndsNextToTheReflectionGivesAllOrNothing) {
    const Vec3 source(0.0, 2.0, 0.0), image(0.0, -2.0, 0.0), listener(3.0, 1.0, 0.4);
    const double distance = glm::distance(image, listener);
    constexpr double kReflection = 2.0;  // x of the point that reflects
    constexpr int kSeeds = 100;
    for (const double beyond : {0.25, 0.05, 0.001, -0.001, -0.25}) {
        const OneMaterialScene scene(mirror_up_to(kReflection + beyond), 0.0, 0.0);
        double sum = 0.0, squares = 0.0;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            const RayOptions options = {.rays = 10000,
                                        .seed = static_cast<std::uint64_t>(seed),
                                        .length = 0.04,
                                        .bin = 1e-4,
                                        .specular_order = 0,
                                        .air_absorption = false,
                                        .report_directions = true};
            const LateEnergy late = trace_late_rays(scene.scene(),
                                                    {.pose = {.position = source}},
                                                    std::vector<Vec3>{listener},
                                                    options);
            const audio::EnergyHistogram& histogram = late.listeners[0];
            const double energy = sum_of(histogram);
            sum += energy / kSeeds;
            squares += energy * energy / kSeeds;
            // At one instant and from one direction.
            const auto bin = static_cast<std::size_t>(distance / kSpeed / options.bin);
            EXPECT_EQ(histogram.energy[bin][kBand], energy);
            const Vec3 towards = image - listener;
            const std::size_t part = audio::direction_part({towards.x, towards.y, towards.z});
            EXPECT_NEAR(
                histogram.directions[bin / audio::kBinsPerSpan][part][kBand], energy, 1e-12);
        }
        if (beyond < 0.0) {
            EXPECT_EQ(sum, 0.0) << beyond;
            continue;
        }
        const double error = std::sqrt((squares - sum * sum) / (kSeeds - 1.0));
        EXPECT_NEAR(sum * distance * distance, 1.0, 4.0 * error * distance * distance) << beyond;
        EXPECT_LT(error * distance * distance, 0.02) << beyond;
    }
}

// Two mirrors at a right angle, one of which ends at the second reflection: the listener sees
// the image in both or not.
TEST(ImageVisibility, ChainsOfSeveralMirrorsAreSeenOrNot) {
    // A floor, and a wall at x = 0 from the floor up to some height.
    const auto corner = [](double height) {
        geometry::Mesh mesh;
        mesh.positions = {
            {0, 0, -30}, {0, 0, 30}, {30, 0, 30}, {30, 0, -30}, {0, height, -30}, {0, height, 30}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 1}};
        return mesh;
    };
    const Vec3 source(1.0, 3.0, 0.0), listener(3.0, 1.0, 0.5);
    // The way over the floor and the wall: from the image (-1, -3, 0) to (3, 1, 0.5), which passes
    // the wall's plane at y = -2 and the floor's at x = 2: the floor is the last mirror, and the
    // wall reflects at y = 2 on the other side of it.
    const Vec3 images[3] = {{1, -3, 0}, {-1, 3, 0}, {-1, -3, 0}};
    const auto energy_of = [&](int i) {
        const Vec3 apart = images[i] - listener;
        return 1.0 / glm::dot(apart, apart);
    };
    for (const double beyond : {0.1, -0.1}) {
        const OneMaterialScene scene(corner(2.0 + beyond), 0.0, 0.0);
        const LateEnergy late = traced(scene, source, {listener}, 400000, 0, 0.1);
        // The wall alone would reflect at y = 2.5, above its end.
        const double expected = energy_of(0) + (beyond > 0.0 ? energy_of(2) : 0.0);
        EXPECT_NEAR(sum_of(late.listeners[0]) / expected, 1.0, 0.02) << beyond;
    }
}

/// A table top in a room.
struct RoomWithTable : OneMaterialScene {
    RoomWithTable() : OneMaterialScene(mesh_with_table(), 0.15, 0.1) {}

    static geometry::Mesh mesh_with_table() {
        geometry::Mesh mesh = box_mesh({6.0, 2.8, 5.0});
        geometry::Mesh table = box_mesh({1.6, 0.05, 0.8});
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (const Vec3& position : table.positions) {
            mesh.positions.push_back(position + Vec3(2.2, 0.69, 2.1));
        }
        for (const geometry::Triangle& triangle : table.triangles) {
            mesh.triangles.push_back(
                {first + triangle[0], first + triangle[1], first + triangle[2]});
        }
        return mesh;
    }
};

// Over a table most of the ball sees other images than the listener does. The exchanged run has
// its ball about a source that stands free.
TEST(ImageVisibility, OverATableTheEnergyIsThatOfTheExchangedRun) {
    const RoomWithTable room;
    const Vec3 source(3.0, 1.2, 1.0);
    const std::vector<Vec3> listeners = {{3.0, 0.7401, 2.5}, {3.0, 0.745, 2.5}, {3.0, 1.04, 2.5}};
    const LateEnergy late = traced(room, source, listeners, 60000, 0, 0.5);
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        const LateEnergy exchanged = traced(room, listeners[k], {source}, 60000, 0, 0.5);
        EXPECT_NEAR(
            10.0 * std::log10(sum_of(late.listeners[k]) / sum_of(exchanged.listeners[0])), 0.0, 0.2)
            << listeners[k].y;
    }
}

}  // namespace
}  // namespace earshot::propagation
