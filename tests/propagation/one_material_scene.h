// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/propagation/late_rays.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::propagation {

/// A mesh of one material, as late rays take it.
struct OneMaterialScene {
    geometry::Mesh mesh;
    std::vector<std::uint32_t> material_of_triangle;
    std::vector<Material> materials{1};
    bvh::DeformableBvh bvh;

    OneMaterialScene(geometry::Mesh the_mesh, double absorption, double scattering)
        : mesh(std::move(the_mesh)), material_of_triangle(mesh.triangles.size(), 0) {
        materials[0].absorption = EnergyCoefficient(absorption);
        materials[0].scattering = EnergyCoefficient(scattering);
        bvh = bvh::DeformableBvh(mesh.view());
    }
    RayScene scene() const { return {{bvh.tree(), mesh.view()}, material_of_triangle, materials}; }
};

/// A closed box from the origin to `size`.
inline geometry::Mesh box_mesh(const geometry::Vec3& size) {
    geometry::Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(
            i & 1 ? size.x : 0.0, i & 2 ? size.y : 0.0, i & 4 ? size.z : 0.0);
    }
    mesh.triangles = {{0, 4, 5},
                      {0, 5, 1},
                      {2, 3, 7},
                      {2, 7, 6},
                      {0, 1, 3},
                      {0, 3, 2},
                      {4, 6, 7},
                      {4, 7, 5},
                      {0, 2, 6},
                      {0, 6, 4},
                      {1, 5, 7},
                      {1, 7, 3}};
    return mesh;
}

}  // namespace earshot::propagation
