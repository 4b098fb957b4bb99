// SPDX-License-Identifier: MIT
#include "earshot/io/internal/gltf_scene.h"

#include <cmath>

namespace earshot::io {
namespace {

std::vector<int> parents_of_nodes(const GltfFile& file) {
    std::vector<int> parents(file.model.nodes.size(), -1);
    for (std::size_t i = 0; i < parents.size(); ++i) {
        for (const int child : file.model.nodes[i].children) {
            int& parent = parents[static_cast<std::size_t>(child)];
            if (parent >= 0) {
                file.fail("node " + std::to_string(child),
                          "it is a child of node " + std::to_string(parent) + " and of node " +
                              std::to_string(i));
            }
            parent = static_cast<int>(i);
        }
    }
    return parents;
}

/// The nodes reachable from `roots` in pre-order, each once.
std::vector<int> depth_first_order(const GltfFile& file, const std::vector<int>& roots) {
    std::vector<int> order;
    std::vector<bool> is_seen(file.model.nodes.size(), false);
    std::vector<int> stack(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
        const auto node = static_cast<std::size_t>(stack.back());
        stack.pop_back();
        if (is_seen[node]) {
            continue;
        }
        is_seen[node] = true;
        order.push_back(static_cast<int>(node));
        const std::vector<int>& children = file.model.nodes[node].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    return order;
}

std::vector<int> roots_of(const std::vector<int>& parents) {
    std::vector<int> roots;
    for (std::size_t i = 0; i < parents.size(); ++i) {
        if (parents[i] < 0) {
            roots.push_back(static_cast<int>(i));
        }
    }
    return roots;
}

/// Of the default scene, else of the first, else all.
std::vector<int> scene_roots(const GltfFile& file, const std::vector<int>& parents) {
    if (file.model.scenes.empty()) {
        return roots_of(parents);
    }
    const int scene = file.model.defaultScene < 0 ? 0 : file.model.defaultScene;
    return file.model.scenes[static_cast<std::size_t>(scene)].nodes;
}

glm::dmat4 matrix_of(const GltfFile& file, std::size_t node) {
    const std::vector<double>& numbers = file.model.nodes[node].matrix;
    glm::dmat4 matrix(1.0);
    for (std::size_t i = 0; i < 16; ++i) {
        matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = numbers[i];
    }
    if (numbers[3] != 0.0 || numbers[7] != 0.0 || numbers[11] != 0.0 || numbers[15] != 1.0) {
        file.fail("node " + std::to_string(node), "the last row of its matrix is not 0, 0, 0, 1");
    }
    return matrix;
}

geometry::Transform transform_of(const GltfFile& file, std::size_t index) {
    const tinygltf::Node& node = file.model.nodes[index];
    geometry::Transform transform;
    if (!node.translation.empty()) {
        transform.translation = {node.translation[0], node.translation[1], node.translation[2]};
    }
    if (!node.scale.empty()) {
        transform.scale = {node.scale[0], node.scale[1], node.scale[2]};
    }
    if (!node.rotation.empty()) {
        const std::vector<double>& q = node.rotation;
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(length > 0.0) || !std::isfinite(length)) {
            file.fail("node " + std::to_string(index), "its rotation is not a unit quaternion");
        }
        transform.rotation = {q[3] / length, q[0] / length, q[1] / length, q[2] / length};
    }
    return transform;
}

}  // namespace

std::string node_name(const GltfFile& file, std::size_t node) {
    const std::string& name = file.model.nodes[node].name;
    return name.empty() ? "node " + std::to_string(node) : name;
}

GltfNodes read_nodes(const GltfFile& file) {
    const std::size_t count = file.model.nodes.size();
    const std::vector<int> parents = parents_of_nodes(file);
    const std::vector<int> order = depth_first_order(file, roots_of(parents));
    GltfNodes read;
    read.index_of.assign(count, -1);
    read.in_scene.assign(count, false);
    read.weight_track.resize(count);
    read.mesh_nodes.resize(count);
    for (const int at : order) {
        const auto index = static_cast<std::size_t>(at);
        const int parent = parents[index];
        geometry::Node node;
        node.name = file.model.nodes[index].name;
        node.parent = parent < 0 ? -1 : read.index_of[static_cast<std::size_t>(parent)];
        if (file.model.nodes[index].matrix.empty()) {
            node.rest = transform_of(file, index);
        } else {
            node.matrix = matrix_of(file, index);
        }
        read.index_of[index] = static_cast<int>(read.nodes.size());
        read.mesh_nodes[index] = {read.index_of[index]};
        read.nodes.push_back(std::move(node));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (read.index_of[i] < 0) {
            file.fail("node " + std::to_string(i), "it is its own ancestor");
        }
    }
    for (const int node : depth_first_order(file, scene_roots(file, parents))) {
        read.in_scene[static_cast<std::size_t>(node)] = true;
    }
    return read;
}

}  // namespace earshot::io
