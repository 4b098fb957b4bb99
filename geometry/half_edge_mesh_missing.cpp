// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/geometry/internal/half_edge_mesh.h"
#include "earshot/geometry/mesh_topology.h"

namespace earshot::geometry {

bool topology_available() noexcept {
    return false;
}

HalfEdgeBorders find_borders(std::span<const Triangle> /*triangles*/,
                             std::size_t /*vertex_count*/) {
    throw Error("topology of meshes",
                "this build is without OpenMesh",
                "install libopenmesh-dev, configure and build again");
}

}  // namespace earshot::geometry
