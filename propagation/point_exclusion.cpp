// SPDX-License-Identifier: MIT
#include "earshot/geometry/tolerance.h"
#include "earshot/propagation/internal/closed_surfaces.h"
#include "earshot/propagation/map_points.h"
#include "earshot/propagation/plausibility.h"

#include <glm/vector_relational.hpp>

#include <algorithm>

namespace earshot::propagation {

using geometry::Vec3;

std::string_view name_of(PointExclusion exclusion) noexcept {
    switch (exclusion) {
        case PointExclusion::none:
            break;
        case PointExclusion::outside:
            return "outside";
        case PointExclusion::in_solid:
            return "in_solid";
        case PointExclusion::near_surface:
            return "near_surface";
    }
    return "";
}

void ExclusionCounts::add(PointExclusion exclusion) noexcept {
    outside += exclusion == PointExclusion::outside ? 1 : 0;
    in_solid += exclusion == PointExclusion::in_solid ? 1 : 0;
    near_surface += exclusion == PointExclusion::near_surface ? 1 : 0;
}

struct AirTest::State {
    const Scene& scene;
    bvh::MeshBvh bvh;
    double clearance;
    std::vector<Vec3> positions;
    SceneExtent extent;
    double tolerance = 0.0;
    std::vector<ClosedSurface> around{};  // all sources
    std::vector<ClosedSurface> solids{};  // without a source

    bool is_inside(const ClosedSurface& surface, const Vec3& point) const {
        return propagation::is_inside(surface, positions, scene.mesh.triangles(), point);
    }
};

// A surface that holds some sources and not others tells nothing: sound passes it, or some pairs
// are silent.
AirTest::AirTest(const Scene& scene, double time, const bvh::MeshBvh& bvh, double clearance)
    : state_(std::make_unique<State>(State{.scene = scene,
                                           .bvh = bvh,
                                           .clearance = clearance,
                                           .positions = scene.mesh.positions_at(time),
                                           .extent = scene_extent(scene, time)})) {
    const auto triangles = scene.mesh.triangles();
    state_->tolerance = geometry::coplanar_tolerance({state_->positions, triangles});
    for (ClosedSurface& surface : closed_surfaces(state_->positions, triangles)) {
        std::size_t inside = 0;
        for (const Emitter& source : scene.sources) {
            inside += state_->is_inside(surface, scene.position_at(source, time)) ? 1 : 0;
        }
        if (inside == 0) {
            state_->solids.push_back(std::move(surface));
        } else if (inside == scene.sources.size()) {
            state_->around.push_back(std::move(surface));
        }
    }
}

AirTest::~AirTest() = default;

PointExclusion AirTest::exclusion_at(const Vec3& point) const {
    const State& state = *state_;
    if (glm::any(glm::lessThan(point, state.extent.lower - state.tolerance)) ||
        glm::any(glm::greaterThan(point, state.extent.upper + state.tolerance))) {
        return PointExclusion::outside;
    }
    if (state.bvh.closest_point(point, std::max(state.clearance, state.tolerance))) {
        return PointExclusion::near_surface;
    }
    const auto is_inside = [&](const ClosedSurface& surface) {
        return state.is_inside(surface, point);
    };
    if (!std::all_of(state.around.begin(), state.around.end(), is_inside)) {
        return PointExclusion::outside;
    }
    return std::any_of(state.solids.begin(), state.solids.end(), is_inside)
               ? PointExclusion::in_solid
               : PointExclusion::none;
}

}  // namespace earshot::propagation
