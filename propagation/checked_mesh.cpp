// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/checked_mesh.h"

#include "earshot/geometry/tolerance.h"

#include <glm/geometric.hpp>

namespace earshot::propagation {

CheckedMesh::CheckedMesh(std::span<const geometry::Vec3> positions,
                         std::span<const geometry::Triangle> triangles,
                         const geometry::CleanMesh& clean,
                         Executor& executor)
    : positions_(positions),
      kept_(clean.kept),
      tolerance_(geometry::coplanar_tolerance({positions, triangles})) {
    triangles_.reserve(kept_.size());
    for (const geometry::TriangleId id : kept_) {
        const auto& [a, b, c] = triangles[id];
        triangles_.push_back({clean.weld[a], clean.weld[b], clean.weld[c]});
    }
    bvh_ = bvh::DeformableBvh(view(), {}, executor);
}

double CheckedMesh::area(std::size_t triangle) const noexcept {
    const auto [a, b, c] = geometry::corners(view(), triangle);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

}  // namespace earshot::propagation
