// SPDX-License-Identifier: MIT
#include "earshot/visibility/sample_free_segments.h"

#include "earshot/visibility/internal/masked_hits.h"
#include "earshot/visibility/internal/random_ray.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace earshot::visibility {

using geometry::MeshView;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

// Samples per batch: enough for the batched traversal, little memory.
constexpr std::size_t kSamplesPerBatch = 65536;
constexpr std::size_t kSamplesPerChunk = 4096;

/// A sample whose line has not left the solids after so many moves is given up.
constexpr int kMaxMoves = 8;

/// A move ends past a face by this fraction of the region's diagonal: well above the rounding of a
/// hit point (1e-15 of the coordinates), well below the width of any object.
constexpr double kStepOut = 1e-9;

/// Whether a ray hits a triangle from behind.
bool hits_back(const MeshView& mesh, TriangleId triangle, const Vec3& direction) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Vec3 normal =
        glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    return glm::dot(normal, direction) > 0.0;
}

/// Moves origins inside of solids out of them, along their rays, and removes the rays that stay
/// inside.
void leave_solids(const bvh::MeshBvh& bvh,
                  const ExclusionMask& excluded,
                  double step_out,
                  std::vector<Ray>& rays,
                  Executor& executor) {
    std::vector<std::size_t> inside(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        inside[i] = i;
    }
    std::vector<std::uint8_t> is_rejected(rays.size(), 0);
    for (int move = 0; !inside.empty(); ++move) {
        std::vector<Ray> moving(inside.size());
        std::transform(
            inside.begin(), inside.end(), moving.begin(), [&](std::size_t i) { return rays[i]; });
        std::vector<std::optional<geometry::Hit>> hits(moving.size());
        closest_hits(bvh, moving, excluded, hits, executor);
        std::vector<std::size_t> still;
        for (std::size_t k = 0; k < inside.size(); ++k) {
            Ray& ray = rays[inside[k]];
            if (!hits[k] || !hits_back(bvh.mesh(), hits[k]->triangle, ray.direction)) {
                continue;
            }
            if (move == kMaxMoves) {
                is_rejected[inside[k]] = 1;
                continue;
            }
            ray.origin += (hits[k]->t + step_out) * ray.direction;
            still.push_back(inside[k]);
        }
        inside = std::move(still);
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (is_rejected[i] == 0) {
            rays[kept++] = rays[i];
        }
    }
    rays.resize(kept);
}

bool is_free_of_solids(const MeshView& mesh, const FreeSegment& free, const Vec3& direction) {
    return (free.at_to == kNoTriangle || !hits_back(mesh, free.at_to, direction)) &&
           (free.at_from == kNoTriangle || !hits_back(mesh, free.at_from, -direction));
}

}  // namespace

std::vector<FreeSegment> sample_free_segments(const bvh::MeshBvh& bvh,
                                              const ViewRegion& region,
                                              const SegmentSampling& sampling,
                                              Executor& executor) {
    validate(region);
    const ExclusionMask excluded = with_degenerate(sampling.excluded, bvh.mesh());
    const double step_out = kStepOut * glm::length(region.size());
    std::vector<FreeSegment> result;
    std::vector<Ray> rays;
    for (std::size_t done = 0; done < sampling.count;) {
        const std::size_t count = std::min(kSamplesPerBatch, sampling.count - done);
        rays.resize(count);
        executor.for_each(count, kSamplesPerChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                rays[i] = random_ray(region, sampling.seed, 0, sampling.first + done + i);
            }
        });
        if (sampling.skip_solids) {
            leave_solids(bvh, excluded, step_out, rays, executor);
        }
        const auto segments = cast_free_segments(bvh, rays, region, excluded, executor);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            if (segments[i].is_valid() &&
                (!sampling.skip_solids ||
                 is_free_of_solids(bvh.mesh(), segments[i], rays[i].direction))) {
                result.push_back(segments[i]);
            }
        }
        done += count;
    }
    return result;
}

}  // namespace earshot::visibility
