// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/masked_hits.h"

#include "earshot/bvh/better_hit.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/predicates.h"

#include <utility>

namespace earshot::visibility {

using geometry::Hit;
using geometry::MeshView;
using geometry::Ray;
using geometry::TriangleId;

namespace {

constexpr std::size_t kGrain = 256;

/// bvh::closest_hit() among the triangles that are not excluded, in double precision throughout.
std::optional<Hit> closest_hit(const bvh::MeshBvh& bvh,
                               const Ray& ray,
                               const ExclusionMask& excluded) noexcept {
    const geometry::PreparedRay prepared(ray, bvh.max_abs_coordinate());
    std::optional<Hit> best;
    if (!prepared.is_valid()) {
        return best;
    }
    double t_max = prepared.t_max();
    bvh.traverse(
        [&](const geometry::Aabb& box) { return !prepared.box_interval(box, t_max).is_empty(); },
        [&](TriangleId id) {
            if (excluded.contains(id)) {
                return true;
            }
            const auto [a, b, c] = bvh.corners(id);
            if (auto hit = prepared.hit(a, b, c, t_max)) {
                hit->triangle = id;
                if (!best || bvh::better_hit(*hit, *best)) {
                    best = hit;
                    t_max = hit->t;
                }
            }
            return true;
        });
    return best;
}

}  // namespace

bool closest_hits(const bvh::MeshBvh& bvh,
                  std::span<const Ray> rays,
                  const ExclusionMask& excluded,
                  std::span<std::optional<Hit>> hits,
                  Executor& executor,
                  const Interrupt& interrupt) {
    if (!bvh.closest_hits(rays, hits, executor, interrupt)) {
        return false;
    }
    if (excluded.is_empty()) {
        return true;
    }
    // The batch ignores the mask, because few rays hit an excluded triangle first; these are traced
    // again.
    executor.for_each(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (hits[i] && excluded.contains(hits[i]->triangle)) {
                hits[i] = closest_hit(bvh, rays[i], excluded);
            }
        }
    });
    return true;
}

ExclusionMask with_degenerate(ExclusionMask excluded, const MeshView& mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = geometry::corners(mesh, i);
        if (!geometry::has_area(a, b, c)) {
            excluded.add(static_cast<TriangleId>(i));
        }
    }
    return excluded;
}

}  // namespace earshot::visibility
