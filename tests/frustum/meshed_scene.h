// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// A mesh made ready for the tracer as a file is: cleaned and grouped into facets, which may
/// deviate from their planes and whose outlines leave out vertices.
class MeshedScene {
public:
    MeshedScene(const geometry::Mesh& mesh, const std::vector<std::uint32_t>& labels) {
        const geometry::CleanMesh clean = geometry::clean(mesh.view());
        mesh_.positions = mesh.positions;
        std::vector<std::uint32_t> kept_labels;
        for (const geometry::TriangleId triangle : clean.kept) {
            mesh_.triangles.push_back(mesh.triangles[triangle]);
            kept_labels.push_back(labels[triangle]);
        }
        facets_ = geometry::find_facets(mesh_.view(), clean.weld, kept_labels);
        bvh_ = bvh::DeformableBvh(mesh_.view());
    }
    explicit MeshedScene(const geometry::Mesh& mesh)
        : MeshedScene(mesh, std::vector<std::uint32_t>(mesh.triangles.size(), 0)) {}

    const geometry::Facets& facets() const { return facets_; }
    SceneView scene_view() const {
        return {.bvh = {bvh_.tree(), mesh_.view()}, .facets = facets_, .one_sided = {}};
    }

private:
    geometry::Mesh mesh_;
    geometry::Facets facets_;
    bvh::DeformableBvh bvh_;
};

}  // namespace earshot::frustum
