// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/geometry/wedge.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/internal/diffracted_sound.h"
#include "earshot/propagation/internal/scene_geometry.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <functional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What diffracted paths need of a simulation beside its geometry.
struct DiffractionSettings {
    const audio::Bands& bands;
    const AirAbsorption& air;
    std::span<const audio::Spectrum> reflection;  ///< pressure factor per material
    double speed_of_sound = 0.0;
    bool air_absorption = true;
    int max_order = 0;  ///< of specular paths, and of reflections beside an edge
    double max_length = 0.0;
    /// What is_wanted() asks of the loudest band at least: paths certain to be fainter need not be
    /// evaluated. 0: nothing.
    double min_pressure = 0.0;
    std::function<bool(const Path&)> is_wanted{};
};

/// The diffracted paths of a scene at one instant.
class DiffractedPaths {
public:
    /// Finds the wedges. Everything must outlive it.
    DiffractedPaths(const Scene& scene,
                    const SceneGeometry& geometry,
                    const DiffractionSettings& settings,
                    Executor& executor);

    /// Adds paths, and the arrivals of energies, to the pairs of a source, which have their
    /// specular paths. `listeners`: where they were asked for.
    void add(const RaySource& source,
             const frustum::PlacedPairs& placed,
             std::span<const geometry::Vec3> listeners,
             std::span<PairResult> pairs,
             Executor& executor) const;

private:
    SpecularPaths specular_paths(const PairResult& pair) const;
    bool may_be_wanted(const frustum::EdgePath& way, double loudest) const;
    void add_to_pair(const RaySource& source,
                     const geometry::Vec3& from,
                     const geometry::Vec3& to,
                     std::span<frustum::EdgePath> ways,
                     PairResult& pair) const;

    const Scene& scene_;
    const SceneGeometry& geometry_;
    DiffractionSettings settings_;
    frustum::SceneView view_;
    std::vector<geometry::Wedge> wedges_;
    std::vector<geometry::FacetId> facet_of_triangle_;  // by the numbers of the scene
    std::vector<audio::Spectrum> reflection_of_facet_;
};

}  // namespace earshot::propagation
