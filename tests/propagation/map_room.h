// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/map_points.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include "one_material_scene.h"
#include <utility>

namespace earshot::propagation {

/// A room of 8 x 3 x 6 m with a block of its own material in it, 1.5 m high, and a source.
inline Scene room_with_block() {
    Scene scene = shoebox_room({8, 3, 6});
    geometry::Mesh mesh;
    mesh.positions = scene.mesh.positions_at(0.0);
    mesh.triangles.assign(scene.mesh.triangles().begin(), scene.mesh.triangles().end());
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    const geometry::Mesh block = box_mesh({1, 1.5, 1});
    for (const geometry::Vec3& position : block.positions) {
        mesh.positions.push_back(position + geometry::Vec3(3, 0, 2));
    }
    for (const geometry::Triangle& t : block.triangles) {
        // Turned outside: the triangles of box_mesh() face the inside.
        mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
        scene.material_of_triangle.push_back(static_cast<std::uint32_t>(scene.materials.size()));
    }
    scene.materials.push_back({.name = "block", .absorption = EnergyCoefficient(0.3)});
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.name = "room with a block";
    scene.sources.push_back({.name = "talker", .position = {1.1, 1.5, 1.3}});
    return scene;
}

/// Its geometry, as rays see it.
struct MapRoom {
    Scene scene = room_with_block();
    Simulator simulator{scene};
    AirTest air{scene, 0.0, simulator.ray_scene().bvh, 0.1};
};

}  // namespace earshot::propagation
