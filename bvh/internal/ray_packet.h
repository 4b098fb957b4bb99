// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace earshot::bvh {

/// A coherent packet: up to 64 rays from one point, close to each other, that traverse a WideTree
/// together: one box test for all, and edge functions that are linear in the direction. In single
/// precision; distances are depths, in metres along the directions' largest component.
struct RayPacket {
    static constexpr std::size_t kMaxRays = 64;
    /// Rays are tested so many at a time.
    static constexpr std::size_t kGroup = 16;

    std::size_t count = 0;
    std::uint32_t axis[3];  ///< the last is the largest component
    float sign;             ///< of the largest component
    float origin[3];        ///< along these axes, rounded
    float origin_rest[3];   ///< what the rounding left
    float middle[2];        ///< slopes x / |z| and y / |z| of the packet's central ray
    float spread[2];        ///< of slopes, to either side
    float corner_error;     ///< as FloatRay's
    float plane_error;      ///< metres by which boxes are widened
    int order_shift;        ///< of WideNode::order

    // Per ray; up to a multiple of kGroup the last is repeated, with a bound that nothing is
    // within.
    alignas(64) float slope_x[kMaxRays];  ///< relative to the central ray
    alignas(64) float slope_y[kMaxRays];
    alignas(64) float bound[kMaxRays];   ///< no hit farther than this can be the closest
    alignas(64) float inside[kMaxRays];  ///< a hit no farther than this is not beyond t_max
    /// The candidate for the closest hit, which is no closer than this; infinite: there is none.
    alignas(64) float candidate_near[kMaxRays];
    alignas(64) std::uint32_t candidate[kMaxRays];
};

}  // namespace earshot::bvh
