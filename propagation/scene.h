// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/animated_mesh.h"
#include "earshot/propagation/directivity.h"
#include "earshot/propagation/material.h"
#include "earshot/propagation/pose.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace earshot::propagation {

/// A source or a listener: a point (and orientation) that may ride on a node of the scene graph.
struct Emitter {
    std::string name;
    int node = -1;  ///< index into AnimatedMesh::nodes(); -1: stays at `position`
    geometry::Vec3 position{0.0};
    Directivity directivity{};  ///< of a source
    /// A point of the scene to look at, whatever the node does; without one it looks along the
    /// node's -Z, +Y above.
    std::optional<geometry::Vec3> looks_at{};
};

/// Everything a simulation needs to know, read once from a file or made by a program.
struct Scene {
    std::string name;  ///< file name without its folder
    geometry::AnimatedMesh mesh;
    std::vector<Material> materials;
    std::vector<std::uint32_t> material_of_triangle;  ///< index into materials, one per triangle
    std::vector<Emitter> sources;
    std::vector<Emitter> listeners;

    /// Where an emitter of this scene is at time `t` (seconds).
    geometry::Vec3 position_at(const Emitter& emitter, double t) const;
    /// And where it looks. A node whose matrix squeezes an axis flat looks along -Z.
    Pose pose_at(const Emitter& emitter, double t) const;
};

/// A number for a pair of the scene, from the names of its source and listener alone; where a name
/// stands several times, also from how often before. Preconditions: both indices exist.
std::uint64_t pair_key(const Scene& scene, std::size_t source, std::size_t listener);

}  // namespace earshot::propagation
