// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/geometry/animated_mesh.h"
#include "earshot/geometry/vector.h"

#include <algorithm>

namespace earshot::geometry {
namespace {

void require(bool holds, const std::string& subject, const char* what, const char* remedy = "") {
    if (!holds) {
        throw Error(subject, what, remedy);
    }
}

template <typename Values>
bool all_finite(const Values& values) noexcept {
    return std::all_of(values.begin(), values.end(), [](const auto& v) { return is_finite(v); });
}

bool is_index(int index, std::size_t count) noexcept {
    return index >= 0 && static_cast<std::size_t>(index) < count;
}

void validate_track(const Track& track, std::size_t width, const std::string& subject) {
    const std::size_t numbers = track.interpolation == Interpolation::cubic_spline ? 3 : 1;
    require(track.values.size() == track.times.size() * width * numbers,
            subject,
            "the number of key values does not fit the number of key times");
    require(all_finite(track.times) && all_finite(track.values), subject, "a key is not finite");
    require(std::adjacent_find(track.times.begin(), track.times.end(), std::greater_equal<>()) ==
                track.times.end(),
            subject,
            "key times are not strictly ascending");
}

void validate_node(const Node& node, std::size_t index) {
    const std::string subject = "node " + std::to_string(index);
    require(node.parent >= -1 && (node.parent == -1 || is_index(node.parent, index)),
            subject,
            "its parent does not stand before it");
    validate_track(node.translation, 3, subject);
    validate_track(node.rotation, 4, subject);
    validate_track(node.scale, 3, subject);
    const glm::dquat& q = node.rest.rotation;
    require(is_finite(node.rest.translation) && is_finite(node.rest.scale) &&
                is_finite(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w),
            subject,
            "its transform is not finite");
    if (node.matrix) {
        require(is_finite(*node.matrix), subject, "its matrix is not finite");
        require(node.translation.is_empty() && node.rotation.is_empty() && node.scale.is_empty(),
                subject,
                "it has a matrix and is animated",
                "give it a translation, rotation and scale");
    }
}

void validate_skin(const Skin& skin, std::size_t index, std::size_t node_count) {
    const std::string subject = "skin " + std::to_string(index);
    require(skin.inverse_bind.size() == skin.joints.size(),
            subject,
            "the number of inverse bind matrices is not the number of joints");
    require(all_finite(skin.inverse_bind), subject, "an inverse bind matrix is not finite");
    for (const int joint : skin.joints) {
        require(is_index(joint, node_count), subject, "a joint is not a node");
    }
}

void validate_skinning(const Part& part, const Skin& skin, const std::string& subject) {
    require(part.influences_per_vertex > 0 &&
                part.influences.size() == part.positions.size() * part.influences_per_vertex,
            subject,
            "the number of joint weights does not fit the number of vertices");
    for (const JointWeight& influence : part.influences) {
        require(influence.joint < skin.joints.size(), subject, "a joint index is out of range");
        require(is_finite(influence.weight), subject, "a joint weight is not finite");
    }
}

void validate_part(const Part& part,
                   std::size_t index,
                   std::size_t node_count,
                   std::span<const Skin> skins) {
    const std::string subject = "part " + std::to_string(index);
    require(part.node == -1 || is_index(part.node, node_count), subject, "its node does not exist");
    require(all_finite(part.positions), subject, "a position is not finite");
    require(part.rest_weights.size() == part.targets.size(),
            subject,
            "the number of morph weights is not the number of targets");
    require(all_finite(part.rest_weights), subject, "a morph weight is not finite");
    validate_track(part.weights, part.targets.size(), subject);
    for (const MorphTarget& target : part.targets) {
        require(target.displacement.size() == part.positions.size(),
                subject,
                "the number of displacements is not the number of vertices");
        require(all_finite(target.displacement), subject, "a displacement is not finite");
    }
    if (part.skin != -1) {
        require(is_index(part.skin, skins.size()), subject, "its skin does not exist");
        validate_skinning(part, skins[static_cast<std::size_t>(part.skin)], subject);
    }
}

}  // namespace

void AnimatedMesh::validate() const {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        validate_node(nodes_[i], i);
    }
    for (std::size_t i = 0; i < skins_.size(); ++i) {
        validate_skin(skins_[i], i, nodes_.size());
    }
    std::size_t vertex_count = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        validate_part(parts_[i], i, nodes_.size(), skins_);
        vertex_count += parts_[i].positions.size();
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
        for (const VertexId vertex : triangles_[i]) {
            require(vertex < vertex_count,
                    "triangle " + std::to_string(i),
                    "a vertex index is out of range");
        }
    }
}

}  // namespace earshot::geometry
