// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/geometry/animated_mesh.h"
#include "earshot/io/internal/gltf_file.h"

#include <optional>
#include <string>
#include <vector>

namespace earshot::io {

/// One primitive as a part in its own space, with triangles that count its vertices. Vertices that
/// no triangle uses are left out, the others keep their order.
struct GltfPrimitive {
    geometry::Part part;
    std::vector<geometry::Triangle> triangles;
    int material = -1;    ///< index into the file's materials; -1: none
    std::string element;  ///< how errors name it
};

/// Nothing, and a warning, for points and lines. `joint_count` 0: not skinned.
std::optional<GltfPrimitive> read_primitive(const GltfFile& file,
                                            const tinygltf::Primitive& primitive,
                                            const std::string& element,
                                            std::size_t joint_count,
                                            Warnings& warnings);

/// Joints and weights of all sets (JOINTS_0, JOINTS_1, ...) of a primitive, vertex after vertex,
/// scaled so that the weights of a vertex sum to 1.
void read_influences(const GltfFile& file,
                     const tinygltf::Primitive& primitive,
                     const std::string& element,
                     std::size_t joint_count,
                     geometry::Part& part,
                     Warnings& warnings);

}  // namespace earshot::io
