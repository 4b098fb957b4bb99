// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// What a plain mesh file holds.
struct PolygonMesh {
    geometry::Mesh mesh;
    std::vector<std::string> material_names;          ///< in order of first use; may be empty
    std::vector<std::uint32_t> material_of_triangle;  ///< empty where the format knows none
    std::vector<std::string> mesh_names;              ///< empty where the file is one mesh
    std::vector<std::uint32_t> mesh_of_triangle;      ///< likewise; see AnimatedMesh::set_meshes()
};

PolygonMesh parse_obj(std::string_view text, const std::string& file);
PolygonMesh parse_ply(std::string_view bytes, const std::string& file);
PolygonMesh parse_stl(std::string_view bytes, const std::string& file);
PolygonMesh parse_off(std::string_view text, const std::string& file);

/// More corners than any modelled face has; ear cutting takes up to their cube.
inline constexpr std::size_t kMaxPolygonCorners = 1000;

/// Appends one face's triangles. Throws Error naming `face` ("face 3", "line 7") if a corner is not
/// a vertex that stands before it or there are more than kMaxPolygonCorners; faces of fewer than
/// three corners are points and lines, which are left out.
void add_polygon(PolygonMesh& mesh,
                 std::span<const std::int64_t> corners,
                 const std::string& file,
                 const std::string& face);

}  // namespace earshot::io
