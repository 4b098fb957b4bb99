// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/mesh_topology.h"

#include <span>
#include <vector>

namespace earshot::propagation {

/// The triangles of a scene that take part, by welded vertices, with a hierarchy.
class CheckedMesh {
public:
    CheckedMesh(std::span<const geometry::Vec3> positions,
                std::span<const geometry::Triangle> triangles,
                const geometry::CleanMesh& clean,
                Executor& executor);
    CheckedMesh(const CheckedMesh&) = delete;
    CheckedMesh& operator=(const CheckedMesh&) = delete;

    geometry::MeshView view() const noexcept { return {positions_, triangles_}; }
    bvh::MeshBvh bvh() const noexcept { return bvh_.view(); }
    std::size_t size() const noexcept { return triangles_.size(); }
    /// The number of a triangle in the scene.
    geometry::TriangleId original(std::size_t triangle) const noexcept { return kept_[triangle]; }
    double area(std::size_t triangle) const noexcept;
    double tolerance() const noexcept { return tolerance_; }

private:
    std::span<const geometry::Vec3> positions_;
    std::span<const geometry::TriangleId> kept_;
    std::vector<geometry::Triangle> triangles_;
    bvh::DeformableBvh bvh_;
    double tolerance_ = 0.0;
};

}  // namespace earshot::propagation
