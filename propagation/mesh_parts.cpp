// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/mesh_parts.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/topology.h"

#include <glm/geometric.hpp>

namespace earshot::propagation {

using geometry::Corners;
using geometry::Mesh;
using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::VertexId;

bool is_closed_surface(const Mesh& mesh) {
    const geometry::EdgeTable edges(mesh.triangles, mesh.positions.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() % 2 != 0) {
            return false;
        }
    }
    return true;
}

double enclosed_volume(const Mesh& mesh) {
    if (mesh.triangles.empty()) {
        return 0.0;
    }
    // From a corner of its own, so that distant parts round no more.
    const Vec3 origin = mesh.positions[mesh.triangles.front()[0]];
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Corners p = geometry::corners(mesh, t);
        sum += glm::dot(p[0] - origin, glm::cross(p[1] - origin, p[2] - origin));
    }
    return sum / 6.0;
}

Mesh with_label(const Mesh& mesh, std::span<const std::uint32_t> labels, std::uint32_t label) {
    Mesh result;
    std::vector<VertexId> number(mesh.positions.size(), 0xffffffffU);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (labels[t] != label) {
            continue;
        }
        Triangle triangle = mesh.triangles[t];
        for (VertexId& vertex : triangle) {
            VertexId& new_id = number[vertex];
            if (new_id == 0xffffffffU) {
                new_id = static_cast<VertexId>(result.positions.size());
                result.positions.push_back(mesh.positions[vertex]);
            }
            vertex = new_id;
        }
        result.triangles.push_back(triangle);
    }
    return result;
}

double surface_area(const Mesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Corners p = geometry::corners(mesh, t);
        sum += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    }
    return sum;
}

MeshParts find_mesh_parts(const geometry::MeshView& mesh,
                          std::span<const std::uint32_t> labels,
                          Executor& executor) {
    const geometry::CleanMesh clean = geometry::clean(mesh, executor);
    geometry::DisjointSets sets(mesh.positions.size());
    for (const TriangleId id : clean.kept) {
        const auto& [a, b, c] = mesh.triangles[id];
        sets.unite(clean.weld[a], clean.weld[b]);
        sets.unite(clean.weld[a], clean.weld[c]);
    }
    MeshParts result;
    result.dropped = mesh.triangles.size() - clean.kept.size();
    constexpr std::uint32_t kNone = 0xffffffffU;
    std::vector<std::uint32_t> part_of(mesh.positions.size(), kNone);  // per root
    std::vector<VertexId> number(mesh.positions.size(), kNone);        // within its part
    for (const TriangleId id : clean.kept) {
        Triangle triangle = mesh.triangles[id];
        std::uint32_t& part_id = part_of[sets.find(clean.weld[triangle[0]])];
        if (part_id == kNone) {
            part_id = static_cast<std::uint32_t>(result.parts.size());
            result.parts.emplace_back();
        }
        MeshPart& part = result.parts[part_id];
        for (VertexId& vertex : triangle) {
            VertexId& new_id = number[clean.weld[vertex]];
            if (new_id == kNone) {
                new_id = static_cast<VertexId>(part.mesh.positions.size());
                part.mesh.positions.push_back(mesh.positions[clean.weld[vertex]]);
                ++result.vertices;
            }
            vertex = new_id;
        }
        part.mesh.triangles.push_back(triangle);
        part.labels.push_back(labels[id]);
    }
    executor.for_each(result.parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            MeshPart& part = result.parts[i];
            part.is_closed = is_closed_surface(part.mesh);
            part.volume = part.is_closed ? enclosed_volume(part.mesh) : 0.0;
        }
    });
    return result;
}

}  // namespace earshot::propagation
