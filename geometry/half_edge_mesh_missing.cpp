// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/geometry/internal/half_edge_mesh.h"
#include "earshot/geometry/mesh_topology.h"

namespace earshot::geometry {

bool topology_available() noexcept {
    return false;
}

namespace {

[[noreturn]] void fail(const char* subject) {
    throw Error(subject,
                "this build is without OpenMesh",
                "install libopenmesh-dev, configure and build again");
}

}  // namespace

HalfEdgeBorders find_borders(std::span<const Triangle> /*triangles*/,
                             std::size_t /*vertex_count*/) {
    fail("topology of meshes");
}

std::vector<DecimatedTriangle> decimate(const DecimationInput& /*input*/,
                                        const DecimationLimits& /*limits*/) {
    fail("simplification of meshes");
}

}  // namespace earshot::geometry
