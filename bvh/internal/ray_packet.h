// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"
#include "earshot/geometry/sheared_ray.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace earshot::bvh {

/// A coherent packet: up to 64 rays from one point, close to each other, that traverse a WideTree
/// together: one box test for all, and edge functions that are linear in the direction. In single
/// precision, with the bounds of FloatRay; distances are depths, in metres along the directions'
/// largest component.
class RayPacket {
public:
    static constexpr std::size_t kMaxRays = 64;
    // An edge function is summed from three products instead of two, each bounded as FloatRay says.
    static constexpr float kEdgeError = 5.0F;

    /// Gathers as many of the first rays as form a coherent packet, and returns how many: they have
    /// the same origin, directions with the same largest component and the same signs, slopes that
    /// differ little, and lie within the range of FloatRay. 0 if the first does not.
    std::size_t gather(std::span<const geometry::Ray> rays, double reach) noexcept;

    /// A triangle that a ray may hit, no nearer than `near`. Precondition: near <= bound[ray].
    void add(const geometry::MeshView& mesh,
             std::size_t ray,
             std::uint32_t triangle,
             float near) noexcept {
        if (counts_[ray] == kMaxCandidates) {
            settle(mesh, ray);
        }
        candidates_[ray][counts_[ray]++] = {triangle, near};
    }

    /// Decides the candidates of a ray, in double precision.
    void settle(const geometry::MeshView& mesh, std::size_t ray) noexcept;

    /// Visits the candidates of a ray that are still to be decided.
    template <typename Visit>
    void for_each_pending(std::size_t ray, Visit&& visit) const {
        for (std::size_t i = 0; i < counts_[ray]; ++i) {
            if (candidates_[ray][i].near <= bound[ray]) {
                visit(candidates_[ray][i].triangle);
            }
        }
    }

    /// The closest hit among the decided candidates.
    std::optional<geometry::Hit> best(std::size_t ray) const noexcept { return best_[ray]; }
    std::size_t count() const noexcept { return rays_.size(); }

    std::uint32_t axis[3];  ///< the last is the largest component
    float sign;             ///< of the largest component
    float origin[3];        ///< along these axes
    float middle[2];        ///< slopes x / |z| and y / |z| of the packet's central ray
    float spread[2];        ///< of slopes, to either side
    float slack;
    int order_shift;  ///< of WideNode::order

    // Per ray; up to a multiple of eight the last is repeated, with a bound below 0.
    alignas(32) float slope_x[kMaxRays];  ///< relative to the central ray
    alignas(32) float slope_y[kMaxRays];
    alignas(32) float bound[kMaxRays];   ///< no hit farther than this can be the closest
    alignas(32) float inside[kMaxRays];  ///< a hit no farther than this is not beyond t_max

private:
    static constexpr std::size_t kMaxCandidates = 4;
    struct Candidate {
        std::uint32_t triangle;
        float near;
    };

    std::span<const geometry::Ray> rays_;
    double reach_;
    std::array<std::uint8_t, kMaxRays> counts_;
    std::array<std::array<Candidate, kMaxCandidates>, kMaxRays> candidates_;
    std::array<std::optional<geometry::Hit>, kMaxRays> best_;
};

}  // namespace earshot::bvh
