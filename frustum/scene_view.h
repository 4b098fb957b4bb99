// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/facets.h"

#include <cstdint>
#include <span>

namespace earshot::frustum {

/// The scene at one instant, as the path search reads it. Everything is owned by the caller and
/// must outlive the call.
struct SceneView {
    bvh::MeshBvh bvh;                ///< of a clean mesh: no degenerate triangles
    const geometry::Facets& facets;  ///< of that mesh
    /// Per facet: 1 if it reflects on its front only. Empty: every facet reflects on both sides.
    std::span<const std::uint8_t> one_sided{};
    /// Per facet: 1 if sound also goes straight through it, from either side. Empty: none does.
    std::span<const std::uint8_t> transmissive{};
    /// Per facet: the largest factor by which a reflection or transmission there multiplies the
    /// pressure of a path. Empty: 1. For TraceOptions::min_pressure.
    std::span<const double> max_pressure_factor{};

    const geometry::MeshView& mesh() const noexcept { return bvh.mesh(); }
};

}  // namespace earshot::frustum
