// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace earshot::bvh {

/// The planes of WideNode::planes where a ray enters and leaves slabs: the first of eight each.
struct SlabPlanes {
    std::uint32_t near[4], far[4];
};

/// A ray in single precision that passes every box and may hit every triangle that the ray itself
/// passes and hits in double precision (geometry::PreparedRay), with the bounds that prove it.
///
/// Boxes. A ray enters a slab at near = plane * inverse + offset_near and leaves it at far = plane
/// * inverse + offset_far, where the origin is moved outward by kPlanePad.
/// docs/algorithms/bvh-rays.md proves that this is more than all roundings and the padding of
/// geometry::SlabTest.
///
/// Triangles. The origin is a sum of two floats, so that differences to corners beside it are exact
/// but for the rounding of the corners; leaf-inl.h has the bounds.
struct FloatRay {
    alignas(16) float inverse[4];
    alignas(16) float offset_near[4];
    alignas(16) float offset_far[4];
    SlabPlanes planes;
    int order_shift;  ///< of WideNode::order

    std::uint32_t axis[3];             ///< the last is the direction's largest component
    alignas(16) float origin[4];       ///< along x, y and z, rounded
    alignas(16) float origin_rest[4];  ///< what the rounding left
    alignas(16) float shear[4];        ///< the direction over its largest component
    float inverse_depth;               ///< t per metre along the last axis
    float corner_error;                ///< metres by which a coordinate of a corner is off
    float t_max;                       ///< rounded up
    float t_max_inside;                ///< rounded down
};

/// A float that is not below a distance and hardly above it: the product exceeds the rounding of a
/// normal number, the sum that of a smaller one. Unlike geometry::round_up() it has no branch,
/// which would be mispredicted half the time.
inline float float_beyond(double t) noexcept {
    return static_cast<float>(t) * (1.0F + 0x1p-22F) + 0x1p-126F;
}

}  // namespace earshot::bvh
