// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/geometry/animated_mesh.h"
#include "earshot/io/internal/gltf_file.h"

#include <string>
#include <vector>

namespace earshot::io {

/// The node graph of a file in the order AnimatedMesh wants.
struct GltfNodes {
    std::vector<geometry::Node> nodes;          ///< parents before children
    std::vector<int> index_of;                  ///< per node of the file: its index in `nodes`
    std::vector<bool> in_scene;                 ///< per node of the file
    std::vector<geometry::Track> weight_track;  ///< per node of the file: its morph weights

    /// Per node of the file: the indices in `nodes` under which its mesh stands, one per instance
    /// of EXT_mesh_gpu_instancing; its own index where it has no instances.
    std::vector<std::vector<int>> mesh_nodes;
};

/// Throws Error if a node has two parents or is its own ancestor.
GltfNodes read_nodes(const GltfFile& file);

/// Appends the nodes of instances (EXT_mesh_gpu_instancing) as children of the nodes that have
/// them.
void read_instances(const GltfFile& file, GltfNodes& nodes, Warnings& warnings);

/// Puts the tracks of one animation (by name or index; empty: the first) onto the nodes.
void read_animation(const GltfFile& file,
                    const std::string& animation,
                    GltfNodes& nodes,
                    Warnings& warnings);

/// The geometry of a scene as AnimatedMesh wants it.
struct GltfGeometry {
    std::vector<geometry::Skin> skins;
    std::vector<geometry::Part> parts;
    std::vector<geometry::Triangle> triangles;
    std::vector<int> material_of_triangle;  ///< index into the file's materials; -1: none
};

/// All meshes under nodes of the scene: node after node of the file, primitive after primitive.
GltfGeometry read_geometry(const GltfFile& file, const GltfNodes& nodes, Warnings& warnings);

/// How errors and warnings name a node: its name, or "node 3".
std::string node_name(const GltfFile& file, std::size_t node);

}  // namespace earshot::io
