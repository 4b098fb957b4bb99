// SPDX-License-Identifier: MIT
#include "earshot/geometry/animated_mesh.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::geometry {
namespace {

glm::dmat4 local_matrix(const Node& node, double t) {
    if (node.matrix) {
        return *node.matrix;
    }
    Transform now = node.rest;
    std::array<double, 4> value{};
    const std::span<double> four(value);
    const std::span<double> three = four.first(3);
    if (!node.translation.is_empty()) {
        node.translation.sample(t, three, false);
        now.translation = {value[0], value[1], value[2]};
    }
    if (!node.rotation.is_empty()) {
        node.rotation.sample(t, four, true);
        now.rotation = {value[3], value[0], value[1], value[2]};
    }
    if (!node.scale.is_empty()) {
        node.scale.sample(t, three, false);
        now.scale = {value[0], value[1], value[2]};
    }
    return now.matrix();
}

/// glTF 2.0 section 3.7.3.3: the transform of the mesh's own node plays no part.
std::vector<glm::dmat4> joint_matrices(const Skin& skin, std::span<const glm::dmat4> worlds) {
    std::vector<glm::dmat4> matrices(skin.joints.size());
    for (std::size_t i = 0; i < matrices.size(); ++i) {
        matrices[i] = worlds[static_cast<std::size_t>(skin.joints[i])] * skin.inverse_bind[i];
    }
    return matrices;
}

/// Positions in the part's own space at time `t`: base plus weighted displacements.
void morph(const Part& part, double t, std::span<Vec3> out) {
    std::copy(part.positions.begin(), part.positions.end(), out.begin());
    std::vector<double> weights = part.rest_weights;
    if (!part.weights.is_empty()) {
        part.weights.sample(t, weights, false);
    }
    for (std::size_t target = 0; target < weights.size(); ++target) {
        if (weights[target] == 0.0) {
            continue;
        }
        const std::vector<Vec3>& displacement = part.targets[target].displacement;
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] += weights[target] * displacement[i];
        }
    }
}

std::span<const JointWeight> influences_of(const Part& part, std::size_t vertex) {
    return std::span(part.influences)
        .subspan(vertex * part.influences_per_vertex, part.influences_per_vertex);
}

void deform(const Part& part, std::span<const glm::dmat4> joints, std::span<Vec3> positions) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
        Vec3 sum{0.0};
        for (const JointWeight& influence : influences_of(part, i)) {
            if (influence.weight != 0.0) {
                sum += influence.weight * transform_point(joints[influence.joint], positions[i]);
            }
        }
        positions[i] = sum;
    }
}

glm::dmat3 blended_joints(const Part& part,
                          std::span<const glm::dmat4> joints,
                          std::size_t vertex) {
    glm::dmat3 sum(0.0);
    for (const JointWeight& influence : influences_of(part, vertex)) {
        sum += influence.weight * glm::dmat3(joints[influence.joint]);
    }
    return sum;
}

double last_key(const Track& track) noexcept {
    return track.is_empty() ? 0.0 : track.times.back();
}

constexpr std::uint32_t kNoMesh = std::numeric_limits<std::uint32_t>::max();

/// Gives vertices of no mesh that of the vertex before them, or else of the first that has one.
void fill_gaps(std::span<std::uint32_t> mesh_of_vertex) {
    const auto first = std::find_if(mesh_of_vertex.begin(),
                                    mesh_of_vertex.end(),
                                    [](std::uint32_t mesh) { return mesh != kNoMesh; });
    std::uint32_t last = first == mesh_of_vertex.end() ? 0 : *first;
    for (std::uint32_t& mesh : mesh_of_vertex) {
        last = mesh == kNoMesh ? last : mesh;
        mesh = last;
    }
}

}  // namespace

AnimatedMesh::AnimatedMesh(std::vector<Node> nodes,
                           std::vector<Skin> skins,
                           std::vector<Part> parts,
                           std::vector<Triangle> triangles)
    : nodes_(std::move(nodes)),
      skins_(std::move(skins)),
      parts_(std::move(parts)),
      triangles_(std::move(triangles)) {
    validate();
    for (const Node& node : nodes_) {
        duration_ = std::max(
            {duration_, last_key(node.translation), last_key(node.rotation), last_key(node.scale)});
    }
    for (const Part& part : parts_) {
        vertex_count_ += part.positions.size();
        duration_ = std::max(duration_, last_key(part.weights));
    }
    flip_mirrored_winding();
    set_meshes_of_nodes();
}

AnimatedMesh AnimatedMesh::fixed(Mesh mesh) {
    Part part;
    part.positions = std::move(mesh.positions);
    std::vector<Part> parts;
    parts.push_back(std::move(part));
    return {{}, {}, std::move(parts), std::move(mesh.triangles)};
}

void AnimatedMesh::flip_mirrored_winding() {
    // Which vertices are mirrored at time 0. All of a rigid part are, or none.
    const std::vector<glm::dmat4> worlds = node_transforms(0.0);
    std::vector<bool> is_mirrored(vertex_count_, false);
    std::size_t first = 0;
    for (const Part& part : parts_) {
        const std::size_t count = part.positions.size();
        if (part.skin >= 0) {
            const auto joints = joint_matrices(skins_[static_cast<std::size_t>(part.skin)], worlds);
            for (std::size_t i = 0; i < count; ++i) {
                is_mirrored[first + i] = glm::determinant(blended_joints(part, joints, i)) < 0.0;
            }
        } else if (part.node >= 0) {
            const glm::dmat3 linear(worlds[static_cast<std::size_t>(part.node)]);
            std::fill_n(is_mirrored.begin() + static_cast<std::ptrdiff_t>(first),
                        count,
                        glm::determinant(linear) < 0.0);
        }
        first += count;
    }
    for (Triangle& triangle : triangles_) {
        if (is_mirrored[triangle[0]]) {
            std::swap(triangle[1], triangle[2]);
        }
    }
}

void AnimatedMesh::set_meshes_of_nodes() {
    std::vector<std::uint32_t> mesh_of_node(nodes_.size(), kNoMesh);
    mesh_of_vertex_.reserve(vertex_count_);
    for (const Part& part : parts_) {
        auto mesh = static_cast<std::uint32_t>(mesh_names_.size());
        if (part.node >= 0) {
            std::uint32_t& known = mesh_of_node[static_cast<std::size_t>(part.node)];
            mesh = known = std::min(known, mesh);
        }
        if (mesh == mesh_names_.size()) {
            mesh_names_.push_back(part.node < 0 ? std::string()
                                                : nodes_[static_cast<std::size_t>(part.node)].name);
        }
        mesh_of_vertex_.insert(mesh_of_vertex_.end(), part.positions.size(), mesh);
    }
    mesh_of_triangle_.reserve(triangles_.size());
    for (const Triangle& triangle : triangles_) {
        mesh_of_triangle_.push_back(mesh_of_vertex_[triangle[0]]);
    }
}

void AnimatedMesh::set_meshes(std::vector<std::string> names,
                              std::vector<std::uint32_t> mesh_of_triangle) {
    if (mesh_of_triangle.size() != triangles_.size()) {
        throw Error("meshes", "there is not one number for each triangle");
    }
    std::vector<std::uint32_t> mesh_of_vertex(vertex_count_, kNoMesh);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        const std::uint32_t mesh = mesh_of_triangle[i];
        if (mesh >= names.size()) {
            throw Error("meshes",
                        "triangle " + std::to_string(i) + " is of mesh " + std::to_string(mesh) +
                            " of " + std::to_string(names.size()));
        }
        for (const VertexId vertex : triangles_[i]) {
            std::uint32_t& known = mesh_of_vertex[vertex];
            if (known != kNoMesh && known != mesh) {
                throw Error("meshes",
                            "vertex " + std::to_string(vertex) + " is in triangles of two meshes");
            }
            known = mesh;
        }
    }
    std::size_t first = 0;
    for (const Part& part : parts_) {
        fill_gaps(std::span(mesh_of_vertex).subspan(first, part.positions.size()));
        first += part.positions.size();
    }
    mesh_names_ = std::move(names);
    mesh_of_triangle_ = std::move(mesh_of_triangle);
    mesh_of_vertex_ = std::move(mesh_of_vertex);
}

std::vector<glm::dmat4> AnimatedMesh::node_transforms(double t) const {
    std::vector<glm::dmat4> worlds(nodes_.size());
    for (std::size_t i = 0; i < worlds.size(); ++i) {
        const int parent = nodes_[i].parent;
        const glm::dmat4 local = local_matrix(nodes_[i], t);
        worlds[i] = parent < 0 ? local : worlds[static_cast<std::size_t>(parent)] * local;
    }
    return worlds;
}

void AnimatedMesh::positions_at(double t, std::span<Vec3> out) const {
    EARSHOT_ASSERT(out.size() == vertex_count_ && !std::isnan(t));
    const double now = std::clamp(t, 0.0, duration_);
    const std::vector<glm::dmat4> worlds = node_transforms(now);
    std::size_t first = 0;
    for (const Part& part : parts_) {
        const std::span<Vec3> positions = out.subspan(first, part.positions.size());
        first += positions.size();
        morph(part, now, positions);
        if (part.skin >= 0) {
            const auto joints = joint_matrices(skins_[static_cast<std::size_t>(part.skin)], worlds);
            deform(part, joints, positions);
        } else if (part.node >= 0) {
            const glm::dmat4& world = worlds[static_cast<std::size_t>(part.node)];
            for (Vec3& position : positions) {
                position = transform_point(world, position);
            }
        }
    }
}

std::vector<Vec3> AnimatedMesh::positions_at(double t) const {
    std::vector<Vec3> positions(vertex_count_);
    positions_at(t, positions);
    return positions;
}

glm::dmat4 AnimatedMesh::node_transform(int node, double t) const {
    EARSHOT_ASSERT(node >= 0 && static_cast<std::size_t>(node) < nodes_.size() && !std::isnan(t));
    const double now = std::clamp(t, 0.0, duration_);
    std::vector<const Node*> lineage;  // from the node up to its root
    for (int i = node; i >= 0; i = lineage.back()->parent) {
        lineage.push_back(&nodes_[static_cast<std::size_t>(i)]);
    }
    // Multiplied from the root down, as node_transforms does: the same bits.
    glm::dmat4 world = local_matrix(*lineage.back(), now);
    for (auto it = lineage.rbegin() + 1; it != lineage.rend(); ++it) {
        world = world * local_matrix(**it, now);
    }
    return world;
}

}  // namespace earshot::geometry
