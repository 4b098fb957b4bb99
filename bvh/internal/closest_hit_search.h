// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace earshot::bvh {

/// The triangles that may be a ray's closest hit, put off until the bounds of all are known, and
/// then decided in double precision.
class ClosestHitSearch {
public:
    ClosestHitSearch(const geometry::MeshView& mesh,
                     const geometry::Ray& ray,
                     double reach) noexcept
        : mesh_(&mesh), ray_(&ray), reach_(reach) {}

    /// A triangle that is hit, if at all, at `near` or later. Precondition: near <= bound.
    void add(std::uint32_t triangle, float near) noexcept {
        if (count_ == kMost) {
            settle();
        }
        __builtin_prefetch(mesh_->triangles.data() + triangle);
        candidates_[count_++] = {triangle, near};
    }

    /// Visits the candidates that are still to be decided.
    template <typename Visit>
    void for_each_pending(Visit&& visit) const {
        for (std::size_t i = 0; i < count_; ++i) {
            if (candidates_[i].near <= bound) {
                visit(candidates_[i].triangle);
            }
        }
    }

    /// Decides what was added. Lowers `bound` to the best hit.
    void settle() noexcept {
        const geometry::ShearedRay sheared(*ray_);
        for (std::size_t i = 0; i < count_; ++i) {
            if (candidates_[i].near > bound) {
                continue;
            }
            const std::uint32_t id = candidates_[i].triangle;
            const auto [a, b, c] = geometry::corners(*mesh_, id);
            const auto hit = sheared.hit(a, b, c, most(), reach_);
            if (hit && (!best_ || hit->t < best_->t || id < best_->triangle)) {
                best_ = {id, hit->t, hit->u, hit->v};
            }
        }
        count_ = 0;
        if (best_) {
            bound = std::min(bound, geometry::round_up(best_->t));
        }
    }

    /// A hit farther than this cannot be the closest.
    double most() const noexcept { return best_ ? best_->t : ray_->t_max; }

    const std::optional<geometry::Hit>& best() const noexcept { return best_; }

    float bound = 0.0F;  ///< as most(), and what single precision knows of hits not yet decided

private:
    static constexpr std::size_t kMost = 16;
    struct Candidate {
        std::uint32_t triangle;
        float near;
    };

    const geometry::MeshView* mesh_;
    const geometry::Ray* ray_;
    double reach_;
    std::array<Candidate, kMost> candidates_;
    std::size_t count_ = 0;
    std::optional<geometry::Hit> best_;
};

}  // namespace earshot::bvh
