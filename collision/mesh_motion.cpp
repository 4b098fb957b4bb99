// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/mesh_motion.h"

#include "earshot/collision/broad_phase/internal/relative_pose.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>

namespace earshot::collision {

using geometry::Vec3;

namespace {

constexpr std::size_t kMaxSteps = 64;

/// What moves a point of a node from where it is at one instant to where it is at another; nothing
/// if that is not rigid.
std::optional<Pose> displacement(const geometry::AnimatedMesh& scene,
                                 int node,
                                 double t0,
                                 double t1) {
    const glm::dmat4 matrix =
        scene.node_transform(node, t1) * glm::inverse(scene.node_transform(node, t0));
    const Pose pose{glm::dmat3(matrix), Vec3(matrix[3])};
    return is_rigid(pose) ? std::optional(pose) : std::nullopt;
}

/// Whether a screw follows a mesh between two instants.
bool follows(const SceneMeshes& meshes, std::uint32_t mesh, double t0, double t1) {
    const int node = meshes.rigid_node(mesh);
    const auto whole = displacement(meshes.scene(), node, t0, t1);
    if (!whole) {
        return true;  // chords it is
    }
    const Screw screw = Screw::between({}, *whole);
    const std::array<Vec3, 2> box = meshes.node_bounds(mesh);
    const glm::dmat4 start = meshes.scene().node_transform(node, t0);
    // Not only half-way: after two turns a node is there as if it had not moved.
    for (const double fraction : {0.5, 0.381966}) {
        const auto part = displacement(meshes.scene(), node, t0, t0 + fraction * (t1 - t0));
        if (!part) {
            return true;
        }
        const double size = glm::length(glm::dmat3(start) * (box[1] - box[0]));
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 own((corner & 1) != 0 ? box[1].x : box[0].x,
                           (corner & 2) != 0 ? box[1].y : box[0].y,
                           (corner & 4) != 0 ? box[1].z : box[0].z);
            const Vec3 point(start * glm::dvec4(own, 1.0));
            constexpr double kTolerance = 1e-4;
            if (!(glm::length(screw.apply(point, fraction) - part->apply(point)) <=
                  kTolerance * size)) {
                return false;
            }
        }
    }
    return true;
}

std::size_t steps_of(const SceneMeshes& meshes, std::uint32_t mesh, double t0, double t1) {
    if (meshes.rigid_node(mesh) < 0) {
        return 1;
    }
    std::size_t steps = 1;
    const auto all_follow = [&] {
        for (std::size_t i = 0; i < steps; ++i) {
            if (!follows(meshes,
                         mesh,
                         instant_within(t0, t1, i, steps),
                         instant_within(t0, t1, i + 1, steps))) {
                return false;
            }
        }
        return true;
    };
    while (steps < kMaxSteps && !all_follow()) {
        steps *= 2;
    }
    return steps;
}

}  // namespace

double instant_within(double t0, double t1, std::size_t part, std::size_t parts) noexcept {
    return part == parts ? t1
                         : t0 + static_cast<double>(part) / static_cast<double>(parts) * (t1 - t0);
}

std::optional<Screw> screw_between(const SceneMeshes& meshes,
                                   std::uint32_t mesh,
                                   double t0,
                                   double t1) {
    if (meshes.rigid_node(mesh) < 0) {
        return std::nullopt;
    }
    const auto moved = displacement(meshes.scene(), meshes.rigid_node(mesh), t0, t1);
    if (!moved) {
        return std::nullopt;
    }
    const Screw screw = Screw::between({}, *moved);
    return screw.angle > 0.0 ? std::optional(screw) : std::nullopt;
}

std::size_t screw_steps(const SceneMeshes& meshes, double t0, double t1) {
    std::size_t steps = 1;
    for (std::uint32_t mesh = 0; mesh < meshes.size(); ++mesh) {
        steps = std::max(steps, steps_of(meshes, mesh, t0, t1));
    }
    return steps;
}

double turn_of(const SceneMeshes& meshes, std::uint32_t mesh, double t0, double t1) {
    const std::size_t steps = steps_of(meshes, mesh, t0, t1);
    double turn = 0.0;
    for (std::size_t i = 0; i < steps; ++i) {
        const auto screw = screw_between(
            meshes, mesh, instant_within(t0, t1, i, steps), instant_within(t0, t1, i + 1, steps));
        turn += screw ? screw->angle : 0.0;
    }
    return turn;
}

}  // namespace earshot::collision
