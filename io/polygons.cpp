// SPDX-License-Identifier: MIT
#include "earshot/io/internal/polygons.h"

#include "earshot/geometry/predicates.h"
#include "earshot/geometry/triangulate.h"
#include "earshot/io/scene_file.h"

#include <algorithm>
#include <cmath>

namespace earshot::io {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

void clean_position(Vec3& p, std::size_t vertex, const std::string& file) {
    const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const bool is_number = !std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z);
    if (!is_number || largest > kMaxCoordinate) {
        throw Error(file,
                    "vertex " + std::to_string(vertex) +
                        (is_number ? " lies beyond 1e12 m" : " is not a number"),
                    "check the units of the export");
    }
    p = geometry::without_tiny_coordinates(p);
}

bool PolygonList::add(std::span<const std::int64_t> corners, std::size_t number) {
    if (corners.size() > kMaxPolygonCorners) {
        throw Error(file_,
                    name(number) + " has " + std::to_string(corners.size()) + " corners",
                    "split it into faces of at most " + std::to_string(kMaxPolygonCorners));
    }
    if (corners.size() < 3) {
        first_left_out_ = left_out_ == 0 ? number : first_left_out_;
        ++left_out_;
        return false;
    }
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    polygons_.push_back({.number = number, .end = corners_.size()});
    return true;
}

std::span<const std::int64_t> PolygonList::corners(std::size_t face) const {
    const std::size_t begin = face == 0 ? 0 : polygons_[face - 1].end;
    return std::span(corners_).subspan(begin, polygons_[face].end - begin);
}

std::vector<std::uint32_t> PolygonList::triangulate_into(PolygonMesh& mesh) const {
    std::vector<std::uint32_t> triangle_counts;
    triangle_counts.reserve(polygons_.size());
    std::vector<VertexId> vertices;
    for (std::size_t face = 0; face < polygons_.size(); ++face) {
        vertices.clear();
        for (const std::int64_t corner : corners(face)) {
            vertices.push_back(vertex_at(corner, polygons_[face].number, mesh.mesh.positions));
        }
        const std::vector<Triangle> triangles =
            geometry::triangulate(mesh.mesh.positions, vertices);
        mesh.mesh.triangles.insert(mesh.mesh.triangles.end(), triangles.begin(), triangles.end());
        triangle_counts.push_back(static_cast<std::uint32_t>(triangles.size()));
    }
    if (left_out_ > 0) {
        mesh.warnings.push_back({file_,
                                 std::to_string(left_out_) +
                                     " faces of fewer than three corners are left out, the first "
                                     "at " +
                                     name(first_left_out_)});
    }
    return triangle_counts;
}

VertexId PolygonList::vertex_at(std::int64_t corner,
                                std::size_t number,
                                std::vector<Vec3>& positions) const {
    const auto count = static_cast<std::int64_t>(positions.size());
    if (corner < 0 || corner >= count) {
        throw Error(file_,
                    name(number) + ": vertex index " + std::to_string(corner) + " is not in 0.." +
                        std::to_string(count - 1),
                    "export the file again");
    }
    const auto vertex = static_cast<std::size_t>(corner);
    clean_position(positions[vertex], vertex, file_);
    return static_cast<VertexId>(vertex);
}

}  // namespace earshot::io
