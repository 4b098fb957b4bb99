// SPDX-License-Identifier: MIT
#include "earshot/io/internal/obj_groups.h"

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
    const auto next = static_cast<std::uint32_t>(names_.size());
    const auto [entry, is_new] = group_of_name_.emplace(group_, next);
    if (is_new) {
        const std::string& name = object_.empty() ? group_ : object_;
        names_.push_back(name);
        sets_.add();
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
            sets_.unite(known, group);
        }
    }
}

std::vector<std::uint32_t> ObjGroups::mesh_of_group() const {
    std::vector<std::uint32_t> meshes(names_.size());
    geometry::DisjointSets sets = sets_;  // which finding shortens
    std::uint32_t count = 0;
    for (std::uint32_t group = 0; group < names_.size(); ++group) {
        const std::uint32_t root = sets.find(group);
        meshes[group] = root == group ? count++ : meshes[root];
    }
    return meshes;
}

std::vector<std::string> ObjGroups::names() const {
    geometry::DisjointSets sets = sets_;
    std::vector<std::string> names;
    for (std::uint32_t group = 0; group < names_.size(); ++group) {
        if (sets.find(group) == group) {
            names.push_back(names_[group]);
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
