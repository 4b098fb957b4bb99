// SPDX-License-Identifier: MIT
#include "earshot/geometry/feature_edges.h"

#include "earshot/geometry/clean.h"
#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/topology.h"
#include "earshot/geometry/vector.h"

#include <algorithm>
#include <limits>

namespace earshot::geometry {
namespace {

Vec3 unit_normal(const MeshView& mesh, TriangleId id) noexcept {
    const auto [a, b, c] = corners(mesh, id);
    return normalized_or_zero(glm::cross(b - a, c - a));
}

/// The patches in the order of their lowest triangles.
std::vector<std::uint32_t> number_patches(DisjointSets& sets, std::size_t triangles) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> patch_of_root(triangles, kNone), patches(triangles);
    std::uint32_t count = 0;
    for (std::size_t id = 0; id < triangles; ++id) {
        std::uint32_t& patch = patch_of_root[sets.find(static_cast<std::uint32_t>(id))];
        if (patch == kNone) {
            patch = count++;
        }
        patches[id] = patch;
    }
    return patches;
}

}  // namespace

FeatureEdges find_feature_edges(const MeshView& mesh,
                                std::span<const std::uint32_t> labels,
                                double crease_cosine,
                                Executor& executor) {
    const CleanMesh cleaned = clean(mesh, executor);
    std::vector<Triangle> welded;
    welded.reserve(cleaned.kept.size());
    for (const TriangleId id : cleaned.kept) {
        Triangle triangle = mesh.triangles[id];
        for (VertexId& vertex : triangle) {
            vertex = cleaned.weld[vertex];
        }
        welded.push_back(triangle);
    }
    FeatureEdges result;
    DisjointSets patches(mesh.triangles.size());
    for (const DuplicateTriangle& pair : cleaned.duplicates) {
        patches.unite(pair.duplicate, pair.kept);
    }
    const EdgeTable edges(welded, mesh.positions.size());
    for (std::size_t edge = 0; edge < edges.size(); ++edge) {
        const std::span<const HalfEdgeId> uses = edges.uses(edge);
        const TriangleId a = cleaned.kept[triangle_of(uses.front())];
        const TriangleId b = cleaned.kept[triangle_of(uses.back())];
        if (uses.size() == 2 && labels[a] == labels[b]) {
            // Triangles of opposite winding run along their edge the same way.
            const bool is_flipped = start_of(welded, uses.front()) == start_of(welded, uses.back());
            const double cosine = glm::dot(unit_normal(mesh, a), unit_normal(mesh, b));
            if ((is_flipped ? -cosine : cosine) > crease_cosine) {
                patches.unite(a, b);
                continue;
            }
        }
        const VertexId start = start_of(welded, uses.front());
        const VertexId end = end_of(welded, uses.front());
        result.edges.push_back({std::min(start, end), std::max(start, end)});
        result.first.push_back(static_cast<std::uint32_t>(result.triangles.size()));
        for (const HalfEdgeId use : uses) {
            result.triangles.push_back(cleaned.kept[triangle_of(use)]);
        }
    }
    result.first.push_back(static_cast<std::uint32_t>(result.triangles.size()));
    result.patch_of_triangle = number_patches(patches, mesh.triangles.size());
    return result;
}

}  // namespace earshot::geometry
