// SPDX-License-Identifier: MIT
// Volume and surface of the project's scenes, measured by rays, against those of their closed
// meshes.
#include "earshot/propagation/room_statistics.h"

#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/test_paths.h"
#include <string>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

struct ClosedMesh {
    double volume = 0.0, surface = 0.0;
};

/// The air of a scene whose faces all have their front towards it, by the divergence theorem.
ClosedMesh measure(const propagation::Scene& scene) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(0.0);
    ClosedMesh closed;
    for (const auto& [a, b, c] : scene.mesh.triangles()) {
        const Vec3 normal = glm::cross(positions[b] - positions[a], positions[c] - positions[a]);
        closed.surface += 0.5 * glm::length(normal);
        closed.volume -= glm::dot(normal, positions[a]) / 6.0;
    }
    return closed;
}

TEST(RoomStatisticsOfScenes, VolumeAndSurfaceAreThoseOfTheMesh) {
    for (const std::string name :
         {"shoebox", "lroom", "coupled_rooms", "classroom", "concert_hall"}) {
        const auto file = test::source_file("scenes/" + name + ".gltf");
        const propagation::Scene scene = io::load_scene(file).scene;
        const ClosedMesh closed = measure(scene);
        const propagation::Simulator simulator(scene);
        for (const propagation::Emitter& source : scene.sources) {
            const std::vector<Vec3> sources = {scene.position_at(source, 0.0)};
            const auto room = propagation::room_statistics(simulator.ray_scene(), sources);
            ASSERT_TRUE(room.has_value());
            EXPECT_NEAR(room->volume / closed.volume, 1.0, 0.015) << name << " " << source.name;
            EXPECT_NEAR(room->surface / closed.surface, 1.0, 0.01) << name << " " << source.name;
            EXPECT_EQ(room->opening, 0.0) << name;
        }
    }
}

}  // namespace
}  // namespace earshot::support
