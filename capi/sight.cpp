// SPDX-License-Identifier: MIT
// Lines of sight through the mesh of a hierarchy.
#include "earshot/capi/internal/bvh_object.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/segments.h"
#include "earshot/capi/internal/work.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/visibility_matrix.h"
#include "earshot/visibility/visible_share.h"

#include <algorithm>
#include <limits>

using namespace earshot;
using namespace earshot::capi;

es_status es_bvh_exclude(es_bvh bvh, const uint32_t* triangles, size_t count) {
    return call(__func__, [&] {
        const Changing<BvhObject> object(bvh, "bvh");
        visibility::ExclusionMask mask;
        for (const std::uint32_t triangle : require_array(triangles, count, "triangles")) {
            require_index(triangle, object->mesh.triangles.size(), "triangles");
            mask.add(triangle);
        }
        object->excluded = std::move(mask);
    });
}

es_status es_bvh_visible(es_bvh bvh,
                         const double* from,
                         const double* to,
                         size_t count,
                         int32_t threads,
                         uint8_t* visible) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        const auto out = require_array(visible, count, "visible");
        Executor executor(threads);
        const bvh::MeshBvh tree = object->tree.view();
        std::vector<std::uint8_t> found(count);  // handed over when all ends were found right
        for_segments(from,
                     to,
                     count,
                     segments_per_block(tree.tree().bytes()),
                     executor,
                     [&](std::span<const geometry::Segment> some, std::size_t first) {
                         const auto part = visibility::visible(tree, some, object->excluded);
                         std::copy(part.begin(), part.end(), found.data() + first);
                     });
        std::copy(found.begin(), found.end(), out.begin());
    });
}

es_status es_bvh_first_blockers(es_bvh bvh,
                                const double* from,
                                const double* to,
                                size_t count,
                                int32_t threads,
                                uint32_t* triangles,
                                double* t) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        require_array(triangles, count, "triangles");
        Executor executor(threads);
        const bvh::MeshBvh tree = object->tree.view();
        std::vector<std::optional<visibility::Blocker>> found(count);
        for_segments(from,
                     to,
                     count,
                     segments_per_block(tree.tree().bytes()),
                     executor,
                     [&](std::span<const geometry::Segment> some, std::size_t first) {
                         const auto part = visibility::first_blockers(tree, some, object->excluded);
                         std::copy(part.begin(), part.end(), found.data() + first);
                     });
        for (std::size_t i = 0; i < count; ++i) {
            triangles[i] = found[i] ? found[i]->triangle : ES_NONE;
            if (t != nullptr) {
                t[i] = found[i] ? found[i]->t : std::numeric_limits<double>::infinity();
            }
        }
    });
}

es_status es_bvh_visible_matrix(es_bvh bvh,
                                const double* from,
                                size_t from_count,
                                const double* to,
                                size_t to_count,
                                int32_t threads,
                                uint8_t* visible) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        constexpr std::size_t kMaxPairs = std::size_t{1} << 40U;
        const visibility::PointSets points = {.from = require_points(from, from_count, "from"),
                                              .to = require_points(to, to_count, "to")};
        if (to_count > 0 && from_count > kMaxPairs / to_count) {
            fail_argument("to_count", "makes more than 2^40 pairs", "give fewer points at a time");
        }
        std::uint8_t* out = require_array(visible, from_count * to_count, "visible").data();
        Executor executor(threads);
        visibility::visibility_matrix(object->tree.view(),
                                      points,
                                      object->excluded,
                                      executor,
                                      [&](std::span<const std::uint8_t> row) {
                                          out = std::copy(row.begin(), row.end(), out);
                                      });
    });
}

es_status es_bvh_visible_shares(es_bvh bvh,
                                const double* from,
                                size_t from_count,
                                const double* to,
                                size_t to_count,
                                double radius,
                                size_t max_rays,
                                int32_t threads,
                                double* shares,
                                double* errors) {
    return call(__func__, [&] {
        const Reading<BvhObject> object(bvh, "bvh");
        require_threads(threads, "threads");
        constexpr std::size_t kMaxPairs = std::size_t{1} << 32U;
        constexpr std::size_t kMinRays = 8, kMaxRays = std::size_t{1} << 20U;
        constexpr double kMinRadius = std::numeric_limits<double>::min(), kMaxRadius = 1e6;
        const auto eyes = require_points(from, from_count, "from");
        const auto targets = require_points(to, to_count, "to");
        if (to_count > 0 && from_count > kMaxPairs / to_count) {
            fail_argument("to_count", "makes more than 2^32 pairs", "give fewer points at a time");
        }
        require_in(radius, kMinRadius, kMaxRadius, "radius");
        require_count(max_rays, kMinRays, kMaxRays, "max_rays");
        const auto out = require_array(shares, from_count * to_count, "shares");
        Executor executor(threads);
        const visibility::VisibleShareQuery query(object->tree.view(), object->excluded, executor);
        const auto found = query.matrix(eyes, targets, radius, {.max_rays = max_rays}, executor);
        for (std::size_t i = 0; i < found.size(); ++i) {
            out[i] = found[i].share;
            if (errors != nullptr) {
                errors[i] = found[i].error;
            }
        }
    });
}
