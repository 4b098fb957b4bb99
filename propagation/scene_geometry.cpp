// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/scene_geometry.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace earshot::propagation {

std::vector<FacetMaterial> facet_materials(const Scene& scene,
                                           const audio::Bands& bands,
                                           bool transmission) {
    const auto loudest = [&](const audio::Spectrum& pressure) {
        return *std::max_element(pressure.begin(),
                                 pressure.begin() + static_cast<std::ptrdiff_t>(bands.count()));
    };
    std::vector<FacetMaterial> materials;
    for (const Material& material : scene.materials) {
        const double through = transmission ? loudest(transmitted_pressure(material, bands)) : 0.0;
        materials.push_back({.one_sided = material.one_sided,
                             .transmissive = through > 0.0,
                             .max_pressure_factor =
                                 std::max(loudest(reflected_pressure(material, bands)), through)});
    }
    return materials;
}

SceneGeometry::SceneGeometry(const Scene& scene, std::vector<FacetMaterial> materials)
    : scene_(scene), materials_(std::move(materials)) {}

bool SceneGeometry::move(double time, double queries, Executor& executor) {
    moved_.resize(scene_.mesh.vertex_count());
    scene_.mesh.positions_at(time, moved_);
    if (bvh_ && moved_ == positions_) {
        return false;
    }
    positions_.swap(moved_);
    has_facets_ = false;
    wedges_ = nullptr;
    report_.reset();
    bool same_triangles = clean_.update(mesh_of_scene(), executor);
    if (!same_triangles) {
        facet_finder_.reset();
    }
    if (kept().empty()) {
        // The instant before stands, with all that is known of it.
        positions_.swap(moved_);
        if (bvh_) {
            clean_.update(mesh_of_scene(), executor);
        }
        throw Error(scene_.name,
                    "no triangle with an area is left after clean-up",
                    "export the scene with triangles");
    }
    same_triangles = same_triangles || !set_triangles();
    update_bvh(same_triangles, queries, executor);
    return true;
}

geometry::MeshView SceneGeometry::mesh_of_scene() const noexcept {
    return {positions_, scene_.mesh.triangles()};
}

bool SceneGeometry::set_triangles() {
    std::vector<geometry::Triangle> triangles(kept().size());
    std::vector<std::uint32_t> labels(kept().size());
    for (std::size_t i = 0; i < kept().size(); ++i) {
        triangles[i] = scene_.mesh.triangles()[kept()[i]];
        labels[i] = scene_.material_of_triangle[kept()[i]];
    }
    const bool are_new = triangles != triangles_ || labels != labels_;
    triangles_ = std::move(triangles);
    labels_ = std::move(labels);
    return are_new;
}

void SceneGeometry::update_bvh(bool same_triangles, double queries, Executor& executor) {
    if (same_triangles) {
        bvh_->expect_queries(queries);
        // The positions before the swap in move().
        bvh_->update(mesh(), bvh::moved_triangles(mesh(), moved_, executor), executor);
        return;
    }
    if (bvh_) {
        former_updates_ += bvh_->update_statistics();
    }
    ++hierarchies_built_;
    bvh_.emplace(mesh(), bvh::UpdateOptions{}, executor);
}

RayScene SceneGeometry::ray_scene() const noexcept {
    return {.bvh = bvh(), .material_of_triangle = labels_, .materials = scene_.materials};
}

const geometry::Facets& SceneGeometry::facets(Executor& executor) const {
    const std::scoped_lock lock(on_demand_);
    if (!has_facets_) {
        if (!facet_finder_) {
            facet_finder_.emplace(mesh(), clean_.clean().weld, labels_);
        }
        facets_ = facet_finder_->find(mesh(), executor);
        describe_facets();
        has_facets_ = true;
    }
    return facets_;
}

void SceneGeometry::describe_facets() const {
    one_sided_.clear();
    transmissive_.clear();
    max_pressure_factor_.clear();
    for (const geometry::Facet& facet : facets_.facets) {
        const FacetMaterial& material = materials_[labels_[facet.triangles.front()]];
        one_sided_.push_back(material.one_sided ? 1 : 0);
        transmissive_.push_back(material.transmissive ? 1 : 0);
        max_pressure_factor_.push_back(material.max_pressure_factor);
    }
}

frustum::SceneView SceneGeometry::scene_view(Executor& executor) const {
    return {.bvh = bvh(),
            .facets = facets(executor),
            .one_sided = one_sided_,
            .transmissive = transmissive_,
            .max_pressure_factor = max_pressure_factor_};
}

const std::vector<geometry::Wedge>& SceneGeometry::wedges(Executor& executor) const {
    const geometry::Facets& of_facets = facets(executor);
    const std::scoped_lock lock(on_demand_);
    if (wedges_ == nullptr) {
        wedges_ = &wedge_finder_.find(of_facets,
                                      {.one_sided = one_sided_, .transmissive = transmissive_});
    }
    return *wedges_;
}

geometry::CleanReport SceneGeometry::clean_report(Executor& executor) const {
    const std::scoped_lock lock(on_demand_);
    if (!report_) {
        report_ = clean_.report({positions_, scene_.mesh.triangles()}, executor);
    }
    return *report_;
}

bvh::UpdateStatistics SceneGeometry::update_statistics() const noexcept {
    bvh::UpdateStatistics updates = former_updates_;
    updates += bvh_->update_statistics();
    return updates;
}

}  // namespace earshot::propagation
