// SPDX-License-Identifier: MIT
// The hierarchy over a mesh: built, moved, and asked by rays and for closest points.
#include "earshot/capi/internal/bvh_object.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/segments.h"
#include "earshot/capi/internal/work.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace earshot::capi {
namespace {

using geometry::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bvh::UpdateOptions update_options(std::int32_t builder) {
    require_in(std::int64_t{builder}, ES_BUILDER_BINNED_SAH, ES_BUILDER_FAST, "builder");
    constexpr std::array<bvh::Builder, ES_BUILDER_FAST + 1> kBuilders = {
        bvh::Builder::binned_sah,
        bvh::Builder::sweep_sah,
        bvh::Builder::spatial_median,
        bvh::Builder::quality,
        bvh::Builder::lbvh,
        bvh::Builder::hybrid,
        bvh::Builder::fast};
    return {.build = {.builder = kBuilders[static_cast<std::size_t>(builder)]}};
}

es_bvh publish_bvh(geometry::Mesh mesh, std::int32_t builder, std::int32_t threads) {
    require_threads(threads, "threads");
    const bvh::UpdateOptions options = update_options(builder);
    Executor executor(threads);
    return publish(std::make_shared<BvhObject>(std::move(mesh), options, executor));
}

/// Rays of callers. Directions whose squares overflow or vanish have no length.
std::vector<geometry::Ray> rays_of(const double* origins,
                                   const double* directions,
                                   const double* max_t,
                                   std::size_t count) {
    const auto from = require_points(origins, count, "origins");
    require_array(directions, 3 * count, "directions");
    require_finite({directions, 3 * count}, "directions");
    std::vector<geometry::Ray> rays(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 direction(directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]);
        const double largest =
            std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
        constexpr double kShort = 1e-100, kLong = 1e100;
        if (!(largest >= kShort && largest <= kLong)) {
            fail_argument("directions[" + std::to_string(i) + "]",
                          "has no length, or one beyond 1e100",
                          "give directions of about unit length");
        }
        rays[i] = {from[i], direction, max_t == nullptr ? kInfinity : max_t[i]};
        if (!(rays[i].t_max >= 0.0)) {
            fail_argument("max_t[" + std::to_string(i) + "]",
                          "is negative or not a number",
                          "give distances from 0, or infinity");
        }
    }
    return rays;
}

void give_hits(std::span<const std::optional<geometry::Hit>> hits,
               double* t,
               std::uint32_t* triangles,
               double* uv) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const geometry::Hit hit = hits[i].value_or(geometry::Hit{ES_NONE, kInfinity, 0.0, 0.0});
        if (t != nullptr) {
            t[i] = hit.t;
        }
        if (triangles != nullptr) {
            triangles[i] = hit.triangle;
        }
        if (uv != nullptr) {
            uv[2 * i] = hit.u;
            uv[2 * i + 1] = hit.v;
        }
    }
}

/// What of closest points a caller wants; each may be null.
struct ClosestPoints {
    double* distances = nullptr;
    std::uint32_t* triangles = nullptr;
    double* points = nullptr;

    void set(std::size_t i, const std::optional<geometry::ClosestPoint>& found) const {
        if (distances != nullptr) {
            distances[i] = found ? found->distance : kInfinity;
        }
        if (triangles != nullptr) {
            triangles[i] = found ? found->triangle : ES_NONE;
        }
        for (int axis = 0; points != nullptr && axis < 3; ++axis) {
            points[3 * i + static_cast<std::size_t>(axis)] =
                found ? found->point[axis] : std::numeric_limits<double>::quiet_NaN();
        }
    }
};

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_bvh_create(const double* vertices,
                        size_t vertex_count,
                        const uint32_t* triangles,
                        size_t triangle_count,
                        int32_t builder,
                        int32_t threads,
                        es_bvh* bvh) {
    return call(__func__, [&] {
        require(bvh, "bvh");
        const auto positions = require_points(vertices, vertex_count, "vertices");
        *bvh = publish_bvh(
            {.positions = {positions.begin(), positions.end()},
             .triangles = require_triangles(triangles, triangle_count, vertex_count, "triangles")},
            builder,
            threads);
    });
}

es_status es_bvh_create_from_scene(
    es_scene scene, double time, int32_t builder, int32_t threads, es_bvh* bvh) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(bvh, "bvh");
        require_time(time, "time");
        const geometry::AnimatedMesh& mesh = object->loaded.scene.mesh;
        *bvh = publish_bvh({.positions = mesh.positions_at(time), .triangles = mesh.triangles()},
                           builder,
                           threads);
    });
}

es_status es_bvh_update(es_bvh bvh,
                        const double* vertices,
                        size_t vertex_count,
                        double expected_queries,
                        int32_t threads,
                        int32_t* action) {
    return call(__func__, [&] {
        const Changing<BvhObject> object(bvh, "bvh");
        require_size(vertex_count, object->mesh.positions.size(), "vertex_count");
        const auto positions = require_points(vertices, vertex_count, "vertices");
        require_in(expected_queries, 0.0, 1e15, "expected_queries");
        require_threads(threads, "threads");
        Executor executor(threads);
        std::copy(positions.begin(), positions.end(), object->mesh.positions.begin());
        const bvh::UpdateReport report = object->update(expected_queries, executor);
        if (action != nullptr) {
            *action = report.action == bvh::UpdateAction::refit    ? ES_UPDATE_REFIT
                      : report.action == bvh::UpdateAction::repair ? ES_UPDATE_REPAIR
                                                                   : ES_UPDATE_REBUILD;
        }
    });
}

es_status es_bvh_counts(es_bvh bvh, size_t* vertex_count, size_t* triangle_count) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        if (vertex_count != nullptr) {
            *vertex_count = object->mesh.positions.size();
        }
        if (triangle_count != nullptr) {
            *triangle_count = object->mesh.triangles.size();
        }
    });
}

es_status es_bvh_closest_hits(es_bvh bvh,
                              const double* origins,
                              const double* directions,
                              const double* max_t,
                              size_t count,
                              int32_t threads,
                              double* t,
                              uint32_t* triangles,
                              double* uv) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        const std::vector<geometry::Ray> rays = rays_of(origins, directions, max_t, count);
        Executor executor(threads);
        give_hits(object->tree.view().closest_hits(rays, executor), t, triangles, uv);
    });
}

es_status es_bvh_occluded(es_bvh bvh,
                          const double* from,
                          const double* to,
                          size_t count,
                          int32_t threads,
                          uint8_t* occluded) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        const auto out = require_array(occluded, count, "occluded");
        Executor executor(threads);
        std::vector<std::uint8_t> found(count);  // handed over when all ends were found right
        const bvh::MeshBvh tree = object->tree.view();
        for_segments(from,
                     to,
                     count,
                     segments_per_block(0),
                     executor,
                     [&](std::span<const geometry::Segment> some, std::size_t first) {
                         tree.occluded(some, std::span(found).subspan(first, some.size()));
                     });
        std::copy(found.begin(), found.end(), out.begin());
    });
}

es_status es_bvh_closest_points(es_bvh bvh,
                                const double* points,
                                size_t count,
                                double max_distance,
                                int32_t threads,
                                double* distances,
                                uint32_t* triangles,
                                double* closest) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        if (!(max_distance >= 0.0)) {
            fail_argument("max_distance",
                          "is negative or not a number",
                          "give a distance from 0, or infinity");
        }
        const auto from = require_points(points, count, "points");
        const ClosestPoints out = {distances, triangles, closest};
        constexpr std::size_t kGrain = 256;
        Executor executor(threads);
        const bvh::MeshBvh mesh = object->tree.view();
        executor.for_each(count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                out.set(i, mesh.closest_point(from[i], max_distance));
            }
        });
    });
}
