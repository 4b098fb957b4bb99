// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/disjoint_sets.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace earshot::io {

/// The meshes of an OBJ: its groups, of which those that share a vertex index are one mesh. Every
/// `o` begins a new object, even with a name that was used before; a `g` goes on with the group of
/// that name in its object.
class ObjGroups {
public:
    void begin_object(std::string_view name);
    void begin_group(std::string_view name);

    /// Puts the next face into the current group.
    void add_face();

    /// Makes the group of a face one mesh with the groups of earlier faces at its corners. These
    /// count vertices from 0. To be called for every face, once all vertices are known.
    void join_at_vertices(std::size_t face, std::span<const std::int64_t> corners);

    /// Meshes in the order of their first faces, named like their first groups.
    std::vector<std::string> names() const;
    std::vector<std::uint32_t> mesh_of_face() const;

private:
    std::vector<std::uint32_t> mesh_of_group() const;

    std::vector<std::string> names_;  // of the groups, in the order of their first faces
    geometry::DisjointSets sets_;     // of the groups: a mesh takes the name of its first
    std::vector<std::uint32_t> group_of_face_, group_of_vertex_;
    // Groups of the object that have faces.
    std::map<std::string, std::uint32_t, std::less<>> group_of_name_;
    std::string object_, group_;
};

}  // namespace earshot::io
