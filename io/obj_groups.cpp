// SPDX-License-Identifier: MIT
#include "earshot/io/internal/obj_groups.h"

#include <algorithm>
#include <limits>

namespace earshot::io {
namespace {

constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void ObjGroups::begin_object(std::string_view name) {
    object_ = name;
    group_.clear();
    group_of_name_.clear();
}

void ObjGroups::begin_group(std::string_view name) {
    group_ = name;
}

void ObjGroups::add_face() {
    const auto next = static_cast<std::uint32_t>(groups_.size());
    const auto [entry, is_new] = group_of_name_.emplace(group_, next);
    if (is_new) {
        const std::string& name = object_.empty() ? group_ : object_;
        groups_.push_back({name, next});
    }
    group_of_face_.push_back(entry->second);
}

void ObjGroups::join_at_vertices(std::size_t face, std::span<const std::int64_t> corners) {
    const std::uint32_t group = group_of_face_[face];
    for (const std::int64_t corner : corners) {
        const auto vertex = static_cast<std::size_t>(corner);
        if (vertex >= group_of_vertex_.size()) {
            group_of_vertex_.resize(vertex + 1, kNoGroup);
        }
        std::uint32_t& known = group_of_vertex_[vertex];
        if (known == kNoGroup) {
            known = group;
        } else if (known != group) {
            unite(known, group);
        }
    }
}

std::uint32_t ObjGroups::root_of(std::uint32_t group) const {
    while (groups_[group].parent != group) {
        group = groups_[group].parent;
    }
    return group;
}

void ObjGroups::unite(std::uint32_t a, std::uint32_t b) {
    // The earlier group is the root, so a mesh takes its name. Paths stay short: both groups point
    // to the root afterwards.
    const std::uint32_t root_a = root_of(a);
    const std::uint32_t root_b = root_of(b);
    const std::uint32_t root = std::min(root_a, root_b);
    for (const std::uint32_t group : {a, b, root_a, root_b}) {
        groups_[group].parent = root;
    }
}

std::vector<std::uint32_t> ObjGroups::mesh_of_group() const {
    std::vector<std::uint32_t> meshes(groups_.size());
    std::uint32_t count = 0;
    for (std::uint32_t group = 0; group < groups_.size(); ++group) {
        const std::uint32_t root = root_of(group);
        meshes[group] = root == group ? count++ : meshes[root];
    }
    return meshes;
}

std::vector<std::string> ObjGroups::names() const {
    std::vector<std::string> names;
    for (std::uint32_t group = 0; group < groups_.size(); ++group) {
        if (groups_[group].parent == group) {
            names.push_back(groups_[group].name);
        }
    }
    return names;
}

std::vector<std::uint32_t> ObjGroups::mesh_of_face() const {
    const std::vector<std::uint32_t> meshes = mesh_of_group();
    std::vector<std::uint32_t> result;
    result.reserve(group_of_face_.size());
    for (const std::uint32_t group : group_of_face_) {
        result.push_back(meshes[group]);
    }
    return result;
}

}  // namespace earshot::io
