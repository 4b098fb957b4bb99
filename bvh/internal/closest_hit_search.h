// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/better_hit.h"
#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace earshot::bvh {

/// Triangles that single precision cannot exclude from being the closest hit, and where each is hit
/// at the earliest.
struct HitCandidates {
    /// A kernel adds as many as a leaf holds.
    static constexpr std::size_t kMaxAdded = kMaxLeafTriangles;
    static constexpr std::size_t kCapacity = 3 * kMaxAdded;

    std::size_t count = 0;
    std::array<float, kCapacity> near;
    std::array<std::uint32_t, kCapacity> triangles;

    // Where the next ones are written to.
    float* near_end() noexcept { return near.data() + count; }
    std::uint32_t* triangles_end() noexcept { return triangles.data() + count; }

    /// Removes those that begin beyond a bound.
    void remove_beyond(float bound) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            near[kept] = near[i];
            triangles[kept] = triangles[i];
            kept += near[i] <= bound ? 1 : 0;
        }
        count = kept;
    }
};

/// The search for a ray's closest hit. Candidates are deferred until the bounds of more of them are
/// known, and then decided in double precision.
class ClosestHitSearch {
public:
    ClosestHitSearch(const geometry::MeshView& mesh,
                     const geometry::Ray& ray,
                     double max_abs_coordinate) noexcept
        : mesh_(&mesh), ray_(&ray), max_abs_coordinate_(max_abs_coordinate) {}

    HitCandidates candidates;

    /// Makes room for the candidates of a leaf.
    void reserve() noexcept {
        if (candidates.count > HitCandidates::kCapacity - HitCandidates::kMaxAdded) {
            candidates.remove_beyond(bound);
            if (candidates.count > HitCandidates::kCapacity - HitCandidates::kMaxAdded) {
                decide_candidates();
            }
        }
    }

    /// Adds a triangle that is hit, if at all, at `t_near` or later. Precondition: there is room.
    void add(std::uint32_t triangle, float t_near) noexcept {
        *candidates.near_end() = t_near;
        *candidates.triangles_end() = triangle;
        ++candidates.count;
    }

    /// Fetches what the decision of the last candidates will read.
    void prefetch(std::size_t count) const noexcept {
        for (std::size_t i = candidates.count - count; i < candidates.count; ++i) {
            for (const geometry::VertexId vertex : mesh_->triangles[candidates.triangles[i]]) {
                __builtin_prefetch(&mesh_->positions[vertex]);
            }
        }
    }

    /// Visits the candidates that are still to be decided.
    template <typename Visit>
    void for_each_pending(Visit&& visit) const {
        for (std::size_t i = 0; i < candidates.count; ++i) {
            if (candidates.near[i] <= bound) {
                visit(candidates.triangles[i]);
            }
        }
    }

    /// Decides all candidates and lowers `bound` to the best hit.
    void decide_candidates() noexcept {
        if (candidates.count == 0) {
            return;
        }
        const geometry::ShearedRay sheared(*ray_);
        for_each_pending([&](std::uint32_t id) {
            const auto [a, b, c] = geometry::corners(*mesh_, id);
            const auto hit = sheared.hit(a, b, c, t_max(), max_abs_coordinate_);
            if (hit) {
                const geometry::Hit candidate = {id, hit->t, hit->u, hit->v};
                if (!best_ || better_hit(candidate, *best_)) {
                    best_ = candidate;
                }
            }
        });
        candidates.count = 0;
        if (best_) {
            bound = std::min(bound, geometry::round_up(best_->t));
        }
    }

    /// No hit beyond this can be the closest.
    double t_max() const noexcept { return best_ ? best_->t : ray_->t_max; }

    const std::optional<geometry::Hit>& best() const noexcept { return best_; }

    /// No hit beyond this can be the closest, by what is known of decided and of pending
    /// candidates.
    float bound = 0.0F;

private:
    const geometry::MeshView* mesh_;
    const geometry::Ray* ray_;
    double max_abs_coordinate_;
    std::optional<geometry::Hit> best_;
};

}  // namespace earshot::bvh
