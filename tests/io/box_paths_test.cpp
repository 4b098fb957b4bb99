// SPDX-License-Identifier: MIT
// The bytes of paths.json for boxes in files, by the lattice of their images and by frusta.
#include "earshot/io/results.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "support/box_meshes.h"
#include "support/gltf_builder.h"
#include "support/temporary_folder.h"
#include <cstdio>
#include <string>

namespace earshot::io {
namespace {

using geometry::Vec3;
using support::BoxShape;
using support::Dice;

std::string obj_text(const geometry::Mesh& mesh, int digits) {
    std::string text;
    char line[128];
    for (const Vec3& p : mesh.positions) {
        std::snprintf(
            line, sizeof line, "v %.*g %.*g %.*g\n", digits, p.x, digits, p.y, digits, p.z);
        text += line;
    }
    for (const geometry::Triangle& triangle : mesh.triangles) {
        text += "f";
        for (const geometry::VertexId vertex : triangle) {
            text += " " + std::to_string(vertex + 1);
        }
        text += "\n";
    }
    return text;
}

/// A mesh in single precision, on a node that turns and moves it.
std::string glb_bytes(const geometry::Mesh& mesh) {
    test::GltfBuilder builder;
    std::vector<float> positions;
    for (const Vec3& p : mesh.positions) {
        for (int k = 0; k < 3; ++k) {
            positions.push_back(static_cast<float>(p[k]));
        }
    }
    std::vector<std::uint32_t> indices;
    for (const geometry::Triangle& triangle : mesh.triangles) {
        indices.insert(indices.end(), triangle.begin(), triangle.end());
    }
    const int corners = builder.add_accessor<float>("VEC3", positions);
    builder.add_node(
        {{"mesh",
          builder.add_mesh(corners, builder.add_accessor<std::uint32_t>("SCALAR", indices))},
         {"rotation", {0.2, 0.4, -0.1, 0.8888194417315589}},
         {"translation", {1.5, -0.25, 3.0}}});
    builder.json["scenes"] = {{{"nodes", {0}}}};
    return builder.glb();
}

/// Two opposite walls of a square box, each an instance of one mesh, and so on for all three axes.
std::string instanced_glb_bytes() {
    test::GltfBuilder builder;
    const int corners =
        builder.add_accessor<float>("VEC3", {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1});
    const int mesh = builder.add_mesh(
        corners, builder.add_accessor<std::uint32_t>("SCALAR", {0, 1, 2, 0, 2, 3}));
    const double h = 0.7071067811865476;
    const std::vector<std::vector<double>> turns = {{0, 0, 0, 1}, {0, 0, h, h}, {h, 0, 0, h}};
    const std::vector<std::vector<double>> moves = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
    std::vector<int> nodes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            std::vector<double> move = moves[axis];
            for (double& coordinate : move) {
                coordinate *= side;
            }
            nodes.push_back(builder.add_node(
                {{"mesh", mesh}, {"rotation", turns[axis]}, {"translation", move}}));
        }
    }
    const int room = builder.add_node(
        {{"children", nodes}, {"scale", {4.0, 1.5, 3.0}}, {"translation", {0.5, 0.25, -2.0}}});
    builder.json["scenes"] = {{{"nodes", {room}}}};
    return builder.glb();
}

propagation::Scene load(const std::string& name, const std::string& bytes) {
    const test::TemporaryFolder folder;
    return load_scene(folder.file(name, bytes)).scene;
}

/// Every wall of its own material.
void add_walls(propagation::Scene& scene) {
    const auto positions = scene.mesh.positions_at(0.0);
    const auto lies_in = [&](const geometry::Triangle& triangle, const geometry::Triangle& wall) {
        const Vec3& origin = positions[wall[0]];
        const Vec3 normal =
            glm::normalize(glm::cross(positions[wall[1]] - origin, positions[wall[2]] - origin));
        return std::all_of(triangle.begin(), triangle.end(), [&](geometry::VertexId vertex) {
            return std::abs(glm::dot(positions[vertex] - origin, normal)) < 1e-4;
        });
    };
    std::vector<geometry::Triangle> walls;
    scene.materials.clear();
    scene.material_of_triangle.clear();
    for (const geometry::Triangle& triangle : scene.mesh.triangles()) {
        const auto wall = std::find_if(walls.begin(), walls.end(), [&](const auto& candidate) {
            return lies_in(triangle, candidate);
        });
        const auto number = static_cast<std::uint32_t>(wall - walls.begin());
        if (wall == walls.end()) {
            walls.push_back(triangle);
            propagation::Material material;
            material.name = "wall " + std::to_string(number);
            material.absorption = propagation::EnergyCoefficient(0.05 + 0.1 * number);
            scene.materials.push_back(material);
        }
        scene.material_of_triangle.push_back(number);
    }
    EXPECT_EQ(walls.size(), 6U);
}

/// Between random corners of triangles.
void add_points(propagation::Scene& scene, Dice& dice) {
    const auto positions = scene.mesh.positions_at(0.0);
    const auto point = [&] {
        constexpr int kCorners = 6;
        Vec3 sum(0.0);
        for (int i = 0; i < kCorners; ++i) {
            sum +=
                positions[static_cast<std::size_t>(dice.below(static_cast<int>(positions.size())))];
        }
        // The first corner and the last are opposite ones.
        const Vec3 centre = 0.5 * (positions.front() + positions.back());
        return centre + 0.9 * (sum / double{kCorners} - centre);
    };
    scene.sources = {{.name = "s", .position = point()}};
    scene.listeners = {{.name = "a", .position = point()}, {.name = "b", .position = point()}};
}

void expect_equal_files(const propagation::Scene& scene, int order) {
    std::string texts[2];
    for (const bool box_lattice : {false, true}) {
        const propagation::Options options = {.specular_order = order, .box_lattice = box_lattice};
        propagation::Simulator simulator(scene, options);
        const auto pairs = simulator.run();
        EXPECT_EQ(simulator.statistics().frusta == 0, box_lattice);
        texts[box_lattice ? 1 : 0] =
            encode_paths({.scene = scene, .bands = options.bands, .speed_of_sound = 343.2}, pairs);
    }
    EXPECT_GT(texts[0].size(), 1000U);
    EXPECT_TRUE(texts[0] == texts[1]);
}

void expect_equal_files_in(std::uint64_t first, std::uint64_t end, int order) {
    for (std::uint64_t seed = first; seed < end; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Dice dice(seed);
        BoxShape shape = support::random_box(seed, dice);
        const geometry::Mesh mesh = support::box_mesh(shape, dice);
        shape.turn = glm::dmat3(1.0);
        const geometry::Mesh straight = support::box_mesh(shape, dice);
        for (propagation::Scene scene : {load("box.obj", obj_text(mesh, 17)),
                                         load("box.obj", obj_text(mesh, 9)),
                                         load("box.glb", glb_bytes(straight))}) {
            add_walls(scene);
            add_points(scene, dice);
            expect_equal_files(scene, order);
        }
    }
}

TEST(BoxPaths, AreTheBytesThatFrustaGive) {
    expect_equal_files_in(0, 4, 4);
}

TEST(SlowBoxPaths, AreTheBytesThatFrustaGiveInManyBoxes) {
    expect_equal_files_in(4, 34, 6);
}

TEST(BoxPaths, WallsMayBeInstancesOfOneMesh) {
    Dice dice(3);
    propagation::Scene scene = load("box.glb", instanced_glb_bytes());
    add_walls(scene);
    add_points(scene, dice);
    expect_equal_files(scene, 5);
}

}  // namespace
}  // namespace earshot::io
