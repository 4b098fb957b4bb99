// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::propagation {

/// Adds parts to a scene that stays, and makes one of them move: scenes in which one part of many
/// moves.
class SceneWithMovingPart {
public:
    using Vec3 = geometry::Vec3;

    /// `scene`: its geometry at time 0 is what stays, but for the triangles that lie in a box,
    /// which are what moves.
    SceneWithMovingPart(Scene scene, const Vec3& lower, const Vec3& upper)
        : scene_(std::move(scene)) {
        const std::vector<Vec3> positions = scene_.mesh.positions_at(0.0);
        const auto lies_inside = [&](geometry::VertexId vertex) {
            const Vec3& p = positions[vertex];
            return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x &&
                   p.y <= upper.y && p.z <= upper.z;
        };
        for (std::size_t i = 0; i < scene_.mesh.triangles().size(); ++i) {
            const auto& [a, b, c] = scene_.mesh.triangles()[i];
            const bool moves = lies_inside(a) && lies_inside(b) && lies_inside(c);
            add_triangle(
                {positions[a], positions[b], positions[c]}, scene_.material_of_triangle[i], moves);
        }
    }

    /// A parallelepiped along the axes with its fronts outside, or inside for a room.
    void add_box(const Vec3& lower,
                 const Vec3& upper,
                 std::uint32_t material,
                 bool moves = false,
                 bool inside = false) {
        const auto at = [&](int i, int j, int k) {
            return Vec3(
                i == 0 ? lower.x : upper.x, j == 0 ? lower.y : upper.y, k == 0 ? lower.z : upper.z);
        };
        const auto face = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
            add_triangle(inside ? Corners{a, b, c} : Corners{c, b, a}, material, moves);
            add_triangle(inside ? Corners{a, c, d} : Corners{d, c, a}, material, moves);
        };
        face(at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0));
        face(at(0, 0, 1), at(0, 1, 1), at(1, 1, 1), at(1, 0, 1));
        face(at(0, 0, 0), at(0, 0, 1), at(1, 0, 1), at(1, 0, 0));
        face(at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1));
        face(at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1));
        face(at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0));
    }

    /// A seat with a back on four legs, 45 cm wide.
    void add_chair(const Vec3& place, std::uint32_t material, bool moves = false) {
        constexpr double kLegs[][2] = {{0.0, 0.0}, {0.41, 0.0}, {0.0, 0.41}, {0.41, 0.41}};
        for (const auto& leg : kLegs) {
            const Vec3 foot = place + Vec3(leg[0], 0.01, leg[1]);
            add_box(foot, foot + Vec3(0.04, 0.41, 0.04), material, moves);
        }
        add_box(place + Vec3(0, 0.43, 0), place + Vec3(0.45, 0.46, 0.45), material, moves);
        add_box(place + Vec3(0, 0.48, 0), place + Vec3(0.45, 0.9, 0.03), material, moves);
    }

    /// The scene, whose moving part is where the track leads it.
    Scene finish(geometry::Track translation) {
        geometry::Node node;
        node.name = "moving part";
        node.translation = std::move(translation);
        std::vector<geometry::Node> nodes = scene_.mesh.nodes();
        nodes.push_back(std::move(node));
        parts_[1].node = static_cast<int>(nodes.size()) - 1;
        const auto still = static_cast<geometry::VertexId>(parts_[0].positions.size());
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            for (geometry::VertexId& vertex : triangles_[i]) {
                vertex += moves_[i] ? still : 0;
            }
        }
        Scene result = std::move(scene_);
        result.mesh = geometry::AnimatedMesh(
            std::move(nodes), {}, {parts_.begin(), parts_.end()}, std::move(triangles_));
        result.material_of_triangle = std::move(materials_);
        return result;
    }

private:
    using Corners = std::array<Vec3, 3>;

    void add_triangle(const Corners& corners, std::uint32_t material, bool moves) {
        std::vector<Vec3>& positions = parts_[moves ? 1 : 0].positions;
        const auto first = static_cast<geometry::VertexId>(positions.size());
        positions.insert(positions.end(), corners.begin(), corners.end());
        triangles_.push_back({first, first + 1, first + 2});
        moves_.push_back(moves);
        materials_.push_back(material);
    }

    Scene scene_;
    std::array<geometry::Part, 2> parts_;  // what stays, what moves
    std::vector<geometry::Triangle> triangles_;
    std::vector<bool> moves_;
    std::vector<std::uint32_t> materials_;
};

/// From one place to another in a second, by steps that are not round numbers.
inline geometry::Track straight_way(const geometry::Vec3& by) {
    return {.times = {0.0, 1.0}, .values = {0.0, 0.0, 0.0, by.x, by.y, by.z}};
}

/// An office of `rows` x `columns` desks with a chair each, of which the first moves.
inline Scene furnished_office(int rows, int columns) {
    using geometry::Vec3;
    Scene scene;
    scene.name = "office";
    scene.materials = {{.name = "plaster"}, {.name = "wood"}};
    const Vec3 size = {2.0 * columns + 1.0, 2.8, 2.2 * rows + 1.0};
    scene.sources = {{.name = "talker", .position = {0.6, 1.5, 0.7}}};
    scene.listeners = {{.name = "listener", .position = {size.x - 0.8, 1.2, size.z - 0.9}}};
    SceneWithMovingPart office(std::move(scene), Vec3(0.0), Vec3(0.0));
    office.add_box(Vec3(0.0), size, 0, false, true);
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const Vec3 place = {0.8 + 2.0 * column, 0.0, 1.3 + 2.2 * row};
            office.add_box(place + Vec3(0, 0.72, 0), place + Vec3(1.2, 0.75, 0.6), 1);
            office.add_box(place + Vec3(0.02, 0.01, 0), place + Vec3(0.05, 0.7, 0.58), 1);
            office.add_box(place + Vec3(1.15, 0.01, 0), place + Vec3(1.18, 0.7, 0.58), 1);
            office.add_box(place + Vec3(0.4, 0.76, 0.1), place + Vec3(0.8, 1.1, 0.12), 1);
            office.add_chair(place + Vec3(0.35, 0.0, 0.7), 1, row == 0 && column == 0);
        }
    }
    return office.finish(straight_way({0.13, 0.0, 0.21}));
}

/// scenes/classroom.gltf, in which a chair moves.
inline Scene classroom_with_moving_chair(Scene classroom) {
    SceneWithMovingPart scene(std::move(classroom), {2.3, 0.0, 4.6}, {3.2, 0.9, 5.3});
    return scene.finish(straight_way({0.1, 0.0, 0.25}));
}

/// scenes/city.gltf, in which a bus passes two streets away from the source.
inline Scene city_with_moving_bus(Scene city) {
    using geometry::Vec3;
    const Vec3 source = city.position_at(city.sources.front(), 0.0);
    SceneWithMovingPart scene(std::move(city), Vec3(0.0), Vec3(0.0));
    const Vec3 place = source + Vec3(40.0, -source.y + 0.4, -20.0);
    scene.add_box(place, place + Vec3(2.5, 2.7, 11.0), 0, true);
    for (const double x : {0.0, 2.2}) {
        for (const double z : {1.5, 8.0}) {
            const Vec3 wheel = place + Vec3(x, -0.35, z);
            scene.add_box(wheel, wheel + Vec3(0.3, 0.34, 0.9), 0, true);
        }
    }
    return scene.finish(straight_way({0.0, 0.0, 40.0}));
}

/// One source, which walks with move_singer(), and one listener.
inline Scene hall_with_singer(Scene hall) {
    hall.sources.front().position = hall.position_at(hall.sources.front(), 0.0);
    hall.sources.front().node = -1;
    hall.sources.resize(1);
    hall.listeners.resize(1);
    return hall;
}

/// By a step of `seconds`.
inline void move_singer(Scene& scene, double seconds) {
    scene.sources.front().position += seconds * geometry::Vec3(2.0, 0.0, 0.7);
}

}  // namespace earshot::propagation
