// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/better_hit.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace earshot::bvh {

/// The search for a ray's closest hit. Candidates, triangles that single precision cannot exclude,
/// are deferred until the bounds of more of them are known, and then decided in double precision.
class ClosestHitSearch {
public:
    ClosestHitSearch(const geometry::MeshView& mesh,
                     const geometry::Ray& ray,
                     double max_abs_coordinate) noexcept
        : mesh_(&mesh), ray_(&ray), max_abs_coordinate_(max_abs_coordinate) {}

    /// Adds a triangle that is hit, if at all, at `t_near` or later. Precondition: t_near <= bound.
    void add(std::uint32_t triangle, float t_near) noexcept {
        if (count_ == kMaxCandidates) {
            decide_candidates();
        }
        __builtin_prefetch(mesh_->triangles.data() + triangle);
        candidates_[count_++] = {triangle, t_near};
    }

    /// Visits the candidates that are still to be decided.
    template <typename Visit>
    void for_each_pending(Visit&& visit) const {
        for (std::size_t i = 0; i < count_; ++i) {
            if (candidates_[i].t_near <= bound) {
                visit(candidates_[i].triangle);
            }
        }
    }

    /// Decides all candidates and lowers `bound` to the best hit.
    void decide_candidates() noexcept {
        const geometry::ShearedRay sheared(*ray_);
        for (std::size_t i = 0; i < count_; ++i) {
            if (candidates_[i].t_near > bound) {
                continue;
            }
            const std::uint32_t id = candidates_[i].triangle;
            const auto [a, b, c] = geometry::corners(*mesh_, id);
            const auto hit = sheared.hit(a, b, c, t_max(), max_abs_coordinate_);
            if (hit) {
                const geometry::Hit candidate = {id, hit->t, hit->u, hit->v};
                if (!best_ || better_hit(candidate, *best_)) {
                    best_ = candidate;
                }
            }
        }
        count_ = 0;
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
    static constexpr std::size_t kMaxCandidates = 16;
    struct Candidate {
        std::uint32_t triangle;
        float t_near;
    };

    const geometry::MeshView* mesh_;
    const geometry::Ray* ray_;
    double max_abs_coordinate_;
    std::array<Candidate, kMaxCandidates> candidates_;
    std::size_t count_ = 0;
    std::optional<geometry::Hit> best_;
};

}  // namespace earshot::bvh
