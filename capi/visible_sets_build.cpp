// SPDX-License-Identifier: MIT
// Visible sets of a scene, as `earshot pvs build` makes them.
#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/visible_sets_object.h"
#include "earshot/capi/internal/work.h"
#include "earshot/visibility/build_visible_sets.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace earshot::capi {
namespace {

// Those of `earshot pvs build`.
constexpr es_visible_sets_options kDefaults = {.struct_size = sizeof(es_visible_sets_options),
                                               .time = 0.0,
                                               .region = nullptr,
                                               .cells = 0,
                                               .grid = nullptr,
                                               .triangles_per_object = 1,
                                               .rays = 0,
                                               .until = -1,
                                               .validation_rays = -1,
                                               .segments = 200000,
                                               .seconds = std::numeric_limits<double>::infinity(),
                                               .seed = 1,
                                               .skip_solids = 0,
                                               .threads = 0,
                                               .progress = nullptr,
                                               .progress_data = nullptr};
constexpr std::size_t kMaxCells = std::size_t{1} << 20U;

void check_cells(const es_visible_sets_options& options) {
    require_count(options.cells, 0, kMaxCells, "options->cells");
    if (options.grid == nullptr) {
        return;
    }
    if (options.cells > 0) {
        fail_argument("options->grid", "is given beside options->cells", "give one of the two");
    }
    std::size_t cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        require_count(options.grid[axis], 1, kMaxCells, "options->grid");
        cells *= options.grid[axis];  // at most 2^60
    }
    require_count(cells, 1, kMaxCells, "the cells of options->grid");
}

es_visible_sets_options checked(const es_visible_sets_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    constexpr std::size_t kMaxTrianglesPerObject = std::size_t{1} << 30U;
    constexpr std::size_t kMaxSegments = 100'000'000;
    constexpr std::int64_t kMaxNumber = std::numeric_limits<std::int64_t>::max();
    const es_visible_sets_options whole =
        require_struct(*options, kDefaults, sizeof(es_visible_sets_options), "options");
    require_time(whole.time, "options->time");
    check_cells(whole);
    require_count(
        whole.triangles_per_object, 1, kMaxTrianglesPerObject, "options->triangles_per_object");
    require_in(whole.until, -1, kMaxNumber, "options->until");
    require_in(whole.validation_rays, -1, kMaxNumber, "options->validation_rays");
    require_count(whole.segments, 1, kMaxSegments, "options->segments");
    if (!(whole.seconds >= 0.0)) {
        fail_argument(
            "options->seconds", "is negative or not a number", "give seconds from 0, or infinity");
    }
    for (const auto& [number, name] :
         {std::pair(whole.rays, "options->rays"), std::pair(whole.seed, "options->seed")}) {
        if (number > static_cast<std::uint64_t>(kMaxNumber)) {
            fail_argument(name, "is 2^63 or more", "give a smaller number");
        }
    }
    require_flag(whole.skip_solids, "options->skip_solids");
    require_threads(whole.threads, "options->threads");
    return whole;
}

visibility::ViewRegion region_of(const double* corners, const bvh::DeformableBvh& hierarchy) {
    if (corners == nullptr) {
        return visibility::region_of(hierarchy.tree().box());
    }
    const auto points = require_points(corners, 2, "options->region");
    const visibility::ViewRegion region = {points[0], points[1]};
    for (int axis = 0; axis < 3; ++axis) {
        if (region.lower[axis] > region.upper[axis]) {
            fail_argument("options->region",
                          "has a lower corner above the upper one",
                          "give the lower corner first");
        }
    }
    return region;
}

Interrupt deadline_of(double seconds) {
    if (std::isinf(seconds)) {
        return {};
    }
    const auto start = std::chrono::steady_clock::now();
    const std::chrono::duration<double> limit(seconds);
    return [start, limit] { return std::chrono::steady_clock::now() - start >= limit; };
}

visibility::VisibleSetsOptions sets_options(const es_visible_sets_options& given,
                                            Progress& progress) {
    visibility::VisibleSetsOptions options = {.max_cells = given.cells,
                                              .triangles_per_object = given.triangles_per_object,
                                              .segments = given.segments,
                                              .skip_solids = given.skip_solids != 0,
                                              .progress = &progress,
                                              .interrupt = deadline_of(given.seconds)};
    if (given.grid != nullptr) {
        options.grid = {given.grid[0], given.grid[1], given.grid[2]};
    }
    if (given.rays > 0) {
        options.max_rays = given.rays;
    }
    if (given.until >= 0) {
        options.until = static_cast<std::uint64_t>(given.until);
    }
    if (given.validation_rays >= 0) {
        options.validation_rays = static_cast<std::uint64_t>(given.validation_rays);
    }
    return options;
}

visibility::VisibleSets build(const propagation::Scene& scene,
                              const es_visible_sets_options& options) {
    Executor executor(options.threads);
    CallbackProgress progress(options.progress, options.progress_data);
    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(options.time);
    const geometry::MeshView mesh = {positions, scene.mesh.triangles()};
    const bvh::DeformableBvh hierarchy(mesh, {}, executor);
    return visibility::build_visible_sets(hierarchy.view(),
                                          region_of(options.region, hierarchy),
                                          sets_options(options, progress),
                                          {.scene = scene.name,
                                           .time = options.time,
                                           .mesh_digest = visibility::mesh_digest(mesh),
                                           .seed = options.seed},
                                          executor);
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_visible_sets_options_init(es_visible_sets_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_visible_sets_options)); });
}

es_status es_visible_sets_build(es_scene scene,
                                const es_visible_sets_options* options,
                                es_visible_sets* sets) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(sets, "sets");
        const es_visible_sets_options given = checked(options);
        require_triangles_of(object->loaded.scene);
        *sets = publish(std::make_shared<VisibleSetsObject>(build(object->loaded.scene, given)));
    });
}
