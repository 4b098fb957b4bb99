// SPDX-License-Identifier: MIT
#include "earshot/visibility/free_segments.h"

#include "earshot/visibility/internal/masked_hits.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace earshot::visibility {

using geometry::Ray;
using geometry::Vec3;

namespace {

constexpr std::size_t kRaysPerChunk = 4096;

ViewRegion around(const ViewRegion& region, const geometry::Aabb& box) {
    ViewRegion all = region;
    if (!box.is_empty()) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            all.lower[axis] = std::min(all.lower[axis], double{box.lower[k]});
            all.upper[axis] = std::max(all.upper[axis], double{box.upper[k]});
        }
    }
    return all;
}

/// The way from a point to the border of a box about it, in multiples of the direction.
double way_out(const Ray& ray, const ViewRegion& all) {
    double way = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double step = ray.direction[axis];
        if (step != 0.0) {
            const double border = step > 0.0 ? all.upper[axis] : all.lower[axis];
            way = std::min(way, (border - ray.origin[axis]) / step);
        }
    }
    return std::isfinite(way) ? std::max(0.0, way) : 0.0;
}

}  // namespace

std::vector<FreeSegment> cast_free_segments(const bvh::MeshBvh& bvh,
                                            std::span<const Ray> rays,
                                            const ViewRegion& region,
                                            const ExclusionMask& excluded,
                                            Executor& executor) {
    std::vector<Ray> both(2 * rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        both[2 * i] = {rays[i].origin, rays[i].direction};
        both[2 * i + 1] = {rays[i].origin, -rays[i].direction};
    }
    std::vector<std::optional<geometry::Hit>> hits(both.size());
    closest_hits(bvh, both, excluded, hits, executor);
    const ViewRegion all = around(region, bvh.tree().box());
    std::vector<FreeSegment> result(rays.size());
    executor.for_each(rays.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
        const auto end_of = [&](std::size_t k) {
            const double t = hits[k] ? hits[k]->t : way_out(both[k], all);
            return both[k].origin + t * both[k].direction;
        };
        for (std::size_t i = begin; i < end; ++i) {
            FreeSegment& free = result[i];
            free.segment = {rays[i].origin, rays[i].origin};
            if (!all.contains(rays[i].origin)) {
                continue;
            }
            free.segment = {end_of(2 * i + 1), end_of(2 * i)};
            free.at_to = hits[2 * i] ? hits[2 * i]->triangle : kNoTriangle;
            free.at_from = hits[2 * i + 1] ? hits[2 * i + 1]->triangle : kNoTriangle;
        }
    });
    return result;
}

geometry::Segment shortened(const geometry::Segment& segment, double metres) noexcept {
    const Vec3 step = segment.to - segment.from;
    const double length = glm::length(step);
    if (length <= 2.0 * metres) {
        const Vec3 middle = segment.from + 0.5 * step;
        return {middle, middle};
    }
    const Vec3 inward = metres / length * step;
    return {segment.from + inward, segment.to - inward};
}

}  // namespace earshot::visibility
