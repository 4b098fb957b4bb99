// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/half_edge_mesh.h"

#include "earshot/base/error.h"
#include "earshot/geometry/mesh_topology.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace earshot::geometry {
namespace {

/// Connectivity alone: positions stay in the caller's arrays, in double precision.
using Connectivity = OpenMesh::TriMesh_ArrayKernelT<>;

Connectivity connectivity_of(std::span<const Triangle> triangles, std::size_t vertex_count) {
    // OpenMesh writes what it refuses to standard error, where the library is silent.
    [[maybe_unused]] static const bool is_silent = [] {
        omerr().disable();
        return true;
    }();
    Connectivity mesh;
    mesh.reserve(vertex_count, 3 * triangles.size(), triangles.size());
    for (std::size_t v = 0; v < vertex_count; ++v) {
        mesh.add_vertex({0.0F, 0.0F, 0.0F});
    }
    const auto handle = [](VertexId vertex) {
        return OpenMesh::VertexHandle(static_cast<int>(vertex));
    };
    for (const auto& [a, b, c] : triangles) {
        if (!mesh.add_face(handle(a), handle(b), handle(c)).is_valid()) {
            throw Error("mesh", "its triangles are not an oriented manifold");
        }
    }
    return mesh;
}

/// The half-edge of the triangle on the other side of a border half-edge.
HalfEdgeId inner_half_edge(const Connectivity& mesh,
                           std::span<const Triangle> triangles,
                           OpenMesh::HalfedgeHandle border) {
    const OpenMesh::HalfedgeHandle inner = mesh.opposite_halfedge_handle(border);
    const auto triangle = static_cast<TriangleId>(mesh.face_handle(inner).idx());
    const auto start = static_cast<VertexId>(mesh.from_vertex_handle(inner).idx());
    HalfEdgeId h = 3 * triangle;
    while (start_of(triangles, h) != start) {
        ++h;
    }
    return h;
}

}  // namespace

bool topology_available() noexcept {
    return true;
}

HalfEdgeBorders find_borders(std::span<const Triangle> triangles, std::size_t vertex_count) {
    const Connectivity mesh = connectivity_of(triangles, vertex_count);
    HalfEdgeBorders borders;
    std::vector<bool> is_visited(mesh.n_halfedges(), false);
    for (const OpenMesh::HalfedgeHandle first : mesh.halfedges()) {
        if (!mesh.is_boundary(first) || is_visited[static_cast<std::size_t>(first.idx())]) {
            continue;
        }
        std::vector<HalfEdgeId>& loop = borders.loops.emplace_back();
        OpenMesh::HalfedgeHandle at = first;
        do {
            is_visited[static_cast<std::size_t>(at.idx())] = true;
            loop.push_back(inner_half_edge(mesh, triangles, at));
            at = mesh.next_halfedge_handle(at);
        } while (at != first);
    }
    return borders;
}

}  // namespace earshot::geometry
