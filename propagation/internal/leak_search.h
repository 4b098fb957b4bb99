// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh_topology.h"
#include "earshot/propagation/internal/checked_mesh.h"
#include "earshot/propagation/model_check.h"
#include "earshot/visibility/air_cut.h"

#include <span>
#include <vector>

namespace earshot::propagation {

struct LeakSearch {
    std::vector<Leak> leaks;  ///< the largest first
    visibility::AirCut cut;   ///< of the triangles of the checked mesh
};

/// Parts air from solid by the visibility graph cut and measures what passes the holes of the mesh,
/// and strips beside its open edges, where a gap has no loop of its own.
LeakSearch find_leaks(const CheckedMesh& mesh,
                      const geometry::MeshTopology& topology,
                      std::span<const geometry::Vec3> points,
                      const visibility::AirCutOptions& options,
                      Executor& executor);

}  // namespace earshot::propagation
