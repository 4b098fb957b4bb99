// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_accessor.h"
#include "earshot/io/internal/gltf_primitive.h"
#include "earshot/io/internal/gltf_scene.h"

#include <algorithm>
#include <limits>

namespace earshot::io {
namespace {

geometry::Skin read_skin(const GltfFile& file, int index, const GltfNodes& nodes) {
    const tinygltf::Skin& skin = file.model.skins[static_cast<std::size_t>(index)];
    geometry::Skin read;
    for (const int joint : skin.joints) {
        read.joints.push_back(nodes.index_of[static_cast<std::size_t>(joint)]);
    }
    read.inverse_bind.assign(read.joints.size(), glm::dmat4(1.0));
    if (skin.inverseBindMatrices < 0) {
        return read;
    }
    const std::vector<double> numbers = accessor_numbers(file, skin.inverseBindMatrices, 16);
    if (numbers.size() / 16 < read.joints.size()) {
        file.fail("skin " + std::to_string(index),
                  std::to_string(numbers.size() / 16) + " inverse bind matrices for " +
                      std::to_string(read.joints.size()) + " joints");
    }
    for (std::size_t i = 0; i < read.joints.size(); ++i) {
        for (std::size_t column = 0; column < 4; ++column) {
            for (std::size_t row = 0; row < 3; ++row) {  // the last row is 0, 0, 0, 1 by definition
                read.inverse_bind[i][static_cast<int>(column)][static_cast<int>(row)] =
                    numbers[i * 16 + column * 4 + row];
            }
        }
    }
    return read;
}

class GeometryReader {
public:
    GeometryReader(const GltfFile& file, const GltfNodes& nodes, Warnings& warnings)
        : file_(file),
          nodes_(nodes),
          warnings_(warnings),
          is_seen_(file.model.meshes.size(), false),
          skin_index_(file.model.skins.size(), -1) {}

    void add_node(std::size_t node_index) {
        const tinygltf::Node& node = file_.model.nodes[node_index];
        if (node.mesh < 0) {
            return;
        }
        const auto mesh_index = static_cast<std::size_t>(node.mesh);
        const tinygltf::Mesh& mesh = file_.model.meshes[mesh_index];
        Warnings repeated;  // a mesh under several nodes is warned about once
        Warnings& warnings = is_seen_[mesh_index] ? repeated : warnings_;
        is_seen_[mesh_index] = true;
        std::vector<GltfPrimitive> primitives = read_primitives(node, mesh, warnings);
        spend(node_index, primitives);
        for (const int mesh_node : nodes_.mesh_nodes[node_index]) {
            for (GltfPrimitive& primitive : primitives) {
                place(node_index, mesh_node, mesh, primitive);
                append(primitive);
            }
        }
    }

    GltfGeometry take() { return std::move(geometry_); }

private:
    std::vector<GltfPrimitive> read_primitives(const tinygltf::Node& node,
                                               const tinygltf::Mesh& mesh,
                                               Warnings& warnings) const {
        std::vector<GltfPrimitive> primitives;
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const std::size_t joint_count =
                node.skin < 0
                    ? 0
                    : file_.model.skins[static_cast<std::size_t>(node.skin)].joints.size();
            auto primitive = read_primitive(
                file_,
                mesh.primitives[i],
                "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(i),
                joint_count,
                warnings);
            if (primitive) {
                primitives.push_back(std::move(*primitive));
            }
        }
        return primitives;
    }

    /// What the parts of a node take in memory, all instances together.
    void spend(std::size_t node_index, const std::vector<GltfPrimitive>& primitives) const {
        // The vertex in the part and in the world, the mesh of each.
        constexpr std::size_t kVertexBytes = 2 * sizeof(geometry::Vec3) + sizeof(std::uint32_t);
        constexpr std::size_t kTriangleBytes =
            sizeof(geometry::Triangle) + 2 * sizeof(std::uint32_t);
        std::size_t bytes = 0;
        for (const GltfPrimitive& primitive : primitives) {
            const geometry::Part& part = primitive.part;
            bytes += sizeof part + primitive.triangles.size() * kTriangleBytes +
                     part.positions.size() *
                         (kVertexBytes + part.targets.size() * sizeof(geometry::Vec3) +
                          part.influences_per_vertex * sizeof(geometry::JointWeight));
        }
        file_.spend("node " + std::to_string(node_index),
                    GltfCost::scene_bytes,
                    nodes_.mesh_nodes[node_index].size(),
                    bytes);
    }

    /// Puts a part under its node and gives it its skin and morph weights.
    void place(std::size_t node_index,
               int mesh_node,
               const tinygltf::Mesh& mesh,
               GltfPrimitive& primitive) {
        const std::string& element = primitive.element;
        const tinygltf::Node& node = file_.model.nodes[node_index];
        geometry::Part& part = primitive.part;
        part.node = mesh_node;
        part.skin = node.skin < 0 ? -1 : skin(node.skin);
        const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
        if (!weights.empty()) {
            if (weights.size() != part.targets.size()) {
                file_.fail(element,
                           std::to_string(weights.size()) + " morph weights for " +
                               std::to_string(part.targets.size()) + " targets");
            }
            part.rest_weights = weights;
        }
        part.weights = nodes_.weight_track[node_index];
        if (mesh.primitives.front().targets.size() != part.targets.size()) {
            file_.fail(element, "its number of morph targets is not that of the first primitive");
        }
    }

    void append(const GltfPrimitive& primitive) {
        const std::size_t total = vertex_count_ + primitive.part.positions.size();
        constexpr std::size_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
        if (total > kMaxCount ||
            geometry_.triangles.size() + primitive.triangles.size() > kMaxCount) {
            file_.fail(primitive.element,
                       "the scene has more than 2^32 vertices or triangles",
                       "split it");
        }
        for (geometry::Triangle triangle : primitive.triangles) {
            for (geometry::VertexId& vertex : triangle) {
                vertex += static_cast<geometry::VertexId>(vertex_count_);
            }
            geometry_.triangles.push_back(triangle);
            geometry_.material_of_triangle.push_back(primitive.material);
        }
        vertex_count_ = total;
        geometry_.parts.push_back(primitive.part);
    }

    int skin(int index) {
        int& known = skin_index_[static_cast<std::size_t>(index)];
        if (known < 0) {
            known = static_cast<int>(geometry_.skins.size());
            geometry_.skins.push_back(read_skin(file_, index, nodes_));
        }
        return known;
    }

    const GltfFile& file_;
    const GltfNodes& nodes_;
    Warnings& warnings_;
    std::vector<bool> is_seen_;  // per mesh
    std::vector<int> skin_index_;
    std::size_t vertex_count_ = 0;
    GltfGeometry geometry_;
};

}  // namespace

GltfGeometry read_geometry(const GltfFile& file, const GltfNodes& nodes, Warnings& warnings) {
    GeometryReader reader(file, nodes, warnings);
    for (std::size_t i = 0; i < file.model.nodes.size(); ++i) {
        if (nodes.in_scene[i]) {
            reader.add_node(i);
        }
    }
    return reader.take();
}

}  // namespace earshot::io
