// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/clean.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/wedges.h"
#include "earshot/propagation/late_energy.h"
#include "earshot/propagation/scene.h"

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What the path search needs to know of a material.
struct FacetMaterial {
    bool one_sided = false;
    bool transmissive = false;
    double max_pressure_factor = 1.0;  ///< see frustum::SceneView
};

/// Of each material of the scene. Without `transmission` nothing is transmissive.
std::vector<FacetMaterial> facet_materials(const Scene& scene,
                                           const audio::Bands& bands,
                                           bool transmission);

/// The geometry of a scene at one instant: the triangles that take part, with the hierarchy over
/// them and their facets. From one instant to the next it keeps what did not change, and follows
/// the rest; what nobody asks for is not made.
class SceneGeometry {
public:
    /// The scene must outlive it.
    SceneGeometry(const Scene& scene, std::vector<FacetMaterial> materials);

    /// Moves everything to where it is at `time`, for about `queries` queries. False: it is where
    /// it was. Invalidates views. Throws Error if no triangle is left after clean-up; it then stays
    /// where it was.
    bool move(double time, double queries, Executor& executor);

    const std::vector<geometry::Vec3>& positions() const noexcept { return positions_; }
    /// Of the triangles that take part: their numbers in the scene.
    std::span<const geometry::TriangleId> kept() const noexcept { return clean_.clean().kept; }
    std::span<const geometry::DuplicateTriangle> duplicates() const noexcept {
        return clean_.clean().duplicates;
    }

    bvh::MeshBvh bvh() const noexcept { return bvh_->view(); }
    RayScene ray_scene() const noexcept;
    /// Made when it is asked for first.
    const geometry::Facets& facets(Executor& executor) const;
    frustum::SceneView scene_view(Executor& executor) const;
    /// The edges that diffract, likewise.
    const std::vector<geometry::Wedge>& wedges(Executor& executor) const;
    geometry::CleanReport clean_report(Executor& executor) const;

    /// How the hierarchy over the triangles has followed them, and how many have been built.
    bvh::UpdateStatistics update_statistics() const noexcept;
    std::uint64_t hierarchies_built() const noexcept { return hierarchies_built_; }

private:
    geometry::MeshView mesh() const noexcept { return {positions_, triangles_}; }
    geometry::MeshView mesh_of_scene() const noexcept;  // before clean-up
    bool set_triangles();                               // whether they are others than before
    void update_bvh(bool same_triangles, double queries, Executor& executor);
    void describe_facets() const;

    const Scene& scene_;
    std::vector<FacetMaterial> materials_;
    std::vector<geometry::Vec3> positions_;
    std::vector<geometry::Vec3> moved_;  // scratch
    geometry::CleanMeshCache clean_;
    std::vector<geometry::Triangle> triangles_;  // that take part
    std::vector<std::uint32_t> labels_;          // their materials
    std::optional<bvh::DeformableBvh> bvh_;      // over them
    bvh::UpdateStatistics former_updates_;       // of hierarchies over other triangles
    std::uint64_t hierarchies_built_ = 0;

    // Made on demand, by const functions that several threads may call.
    mutable std::mutex on_demand_;
    mutable bool has_facets_ = false;
    mutable std::optional<geometry::FacetFinder> facet_finder_;  // of these triangles
    mutable geometry::Facets facets_;
    mutable std::vector<std::uint8_t> one_sided_, transmissive_;  // per facet
    mutable std::vector<double> max_pressure_factor_;             // likewise
    mutable geometry::WedgeFinder wedge_finder_;
    mutable const std::vector<geometry::Wedge>* wedges_ = nullptr;  // its last, if it is of now
    mutable std::optional<geometry::CleanReport> report_;
};

}  // namespace earshot::propagation
