// SPDX-License-Identifier: MIT
#include "earshot/io/internal/polygons.h"

#include "earshot/base/error.h"
#include "earshot/geometry/triangulate.h"

#include <array>

namespace earshot::io {

using geometry::VertexId;

void add_polygon(PolygonMesh& mesh,
                 std::span<const std::int64_t> corners,
                 const std::string& file,
                 const std::string& face) {
    if (corners.size() > kMaxPolygonCorners) {
        throw Error(file,
                    face + " has " + std::to_string(corners.size()) + " corners",
                    "split it into faces of at most " + std::to_string(kMaxPolygonCorners));
    }
    std::array<VertexId, kMaxPolygonCorners> vertices;  // the first corners.size() are set
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto count = static_cast<std::int64_t>(mesh.mesh.positions.size());
        if (corners[i] < 0 || corners[i] >= count) {
            throw Error(file,
                        face + ": vertex index " + std::to_string(corners[i]) + " is not in 0.." +
                            std::to_string(count - 1),
                        "export the file again");
        }
        vertices[i] = static_cast<VertexId>(corners[i]);
    }
    const std::span<const VertexId> polygon = std::span(vertices).first(corners.size());
    for (const geometry::Triangle& triangle : geometry::triangulate(mesh.mesh.positions, polygon)) {
        mesh.mesh.triangles.push_back(triangle);
    }
}

}  // namespace earshot::io
