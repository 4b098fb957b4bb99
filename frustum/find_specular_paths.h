// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/frustum/surface_points.h"

#include <span>

namespace earshot::frustum {

/// Every specular path from `source` to each listener up to options.max_order, for a single
/// question: the one-shot convenience over PathFinder, which keeps what it traced for the next one.
/// Frusta over whole facets find candidate facet sequences; each is then built from exact image
/// sources and its legs are tested against the hierarchy, so no reported path is approximate. A
/// path that meets an edge shared by two facets is reported once. A leg that touches a triangle
/// other than at its own reflection points is blocked, unless the facet is transmissive and the leg
/// does not lie in its plane. Throws Error if an option is out of range.
TraceResult find_specular_paths(const SceneView& scene,
                                const geometry::Vec3& source,
                                std::span<const geometry::Vec3> listeners,
                                const TraceOptions& options = {},
                                Executor& executor = Executor::serial());

/// The direct paths of pairs whose points lie in the air, in a scene of which nothing is
/// transmissive: those that find_specular_paths() finds up to order 0. Asks the triangles alone, so
/// that a scene that deforms needs no facets. Throws Error if an option is out of range.
/// Precondition: options.max_order is 0.
TraceResult find_direct_paths(const bvh::MeshBvh& bvh,
                              const PlacedPairs& pairs,
                              const TraceOptions& options);

}  // namespace earshot::frustum
