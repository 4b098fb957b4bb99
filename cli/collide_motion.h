// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/collision/world.h"
#include "earshot/geometry/animated_mesh.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace earshot::cli {

/// Meshes and how they move, for `earshot collide`.
struct CollideMotion {
    collision::World world;
    std::vector<std::string> mesh_names;
    std::size_t triangles = 0;
    std::vector<double> times;
    /// Moves the meshes of the world from one of the times to another.
    std::function<void(collision::World&, std::size_t, std::size_t)> set_step;
};

/// The meshes of a scene at instants of its animation.
CollideMotion motion_of_scene(geometry::AnimatedMesh mesh,
                              std::vector<double> times,
                              bool weld,
                              collision::Path path);

/// One mesh that has a pose per file. Throws Error if a file has another mesh.
CollideMotion motion_of_poses(const std::vector<std::string>& files,
                              const std::vector<geometry::AnimatedMesh>& meshes,
                              bool weld);

/// Warns of the mesh that turns most during a step, if its vertices' chords are far from its path.
Warnings warn_of_turns(const CollideMotion& motion, const std::string& file);

}  // namespace earshot::cli
