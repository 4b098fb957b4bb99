// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/geometry/mesh.h"
#include "earshot/io/internal/stated_unit.h"

#include <cstdint>
#include <optional>
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
    std::optional<StatedUnit> stated_unit;            ///< in a comment of the file
    Warnings warnings;
};

PolygonMesh parse_obj(std::string_view bytes, const std::string& file);
PolygonMesh parse_ply(std::string_view bytes, const std::string& file);
PolygonMesh parse_stl(std::string_view bytes, const std::string& file);
PolygonMesh parse_off(std::string_view bytes, const std::string& file);

/// More corners than any modelled face has; ear clipping takes their square.
inline constexpr std::size_t kMaxPolygonCorners = 1000;

/// Refuses a position that no geometry can be made of: throws Error. Numbers below kMinCoordinate
/// become 0.
void clean_position(geometry::Vec3& position, std::size_t vertex, const std::string& file);

/// The faces of a file in its order. They are cut into triangles once all vertices are known,
/// because a face may stand before its vertices.
class PolygonList {
public:
    /// `counted_as`: how errors name a face, "line" or "face".
    PolygonList(std::string counted_as, const std::string& file)
        : counted_as_(std::move(counted_as)), file_(file) {}

    /// Adds the face of that number, whose corners count vertices from 0; false for a point or a
    /// line, which is left out. Throws Error for more than kMaxPolygonCorners corners.
    bool add(std::span<const std::int64_t> corners, std::size_t number);

    std::size_t left_out() const noexcept { return left_out_; }

    /// The corners of a face, counting those that add() took.
    std::span<const std::int64_t> corners(std::size_t face) const;

    /// Appends the triangles to `mesh` and a warning for faces that were left out, and returns the
    /// number of triangles of each face. Throws Error if a corner is no vertex.
    std::vector<std::uint32_t> triangulate_into(PolygonMesh& mesh) const;

private:
    struct Polygon {
        std::size_t number = 0;
        std::size_t end = 0;  // one past its last corner
    };

    /// The vertex that a corner of the face of that number names, its position checked.
    geometry::VertexId vertex_at(std::int64_t corner,
                                 std::size_t number,
                                 std::vector<geometry::Vec3>& positions) const;

    std::string name(std::size_t number) const {
        return counted_as_ + " " + std::to_string(number);
    }

    std::string counted_as_;
    const std::string& file_;
    std::vector<std::int64_t> corners_;  // of all polygons, one after another
    std::vector<Polygon> polygons_;
    std::size_t left_out_ = 0;
    std::size_t first_left_out_ = 0;  // its number
};

}  // namespace earshot::io
