// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace earshot::bvh {

/// A ray in single precision that passes every box and may hit every triangle that the ray itself
/// passes and hits in double precision (geometry::PreparedRay), with the bounds that prove it.
///
/// Let R be the largest absolute coordinate of the scene and the origin.
///
/// Boxes. near = plane * inverse_near + offset_near, and far likewise. The planes are exact; the
/// origin, the product with a plane and the offset are off by 2^-24 of R (in units of coordinates)
/// each, so the origin is moved outward by 2^-21 R, which leaves room for the padding of
/// geometry::SlabTest (2^-37 R). The inverses are moved by 2^-21, nearer and farther, which is more
/// than their rounding, the direction's and that of the sum. A component of the direction below
/// 2^-40 of the largest moves a point of the ray that lies in the scene by less than 2^-37 R; its
/// inverse is held at 2^40 of the largest's, so that inside the padded slab `far` lies beyond the
/// scene.
///
/// Triangles. Corners and origin are rounded to 2^-24 of R each, their difference once more; the
/// shear adds as much again: a sheared corner is off by less than 2^-20 R = `slack` in x and y, and
/// less than half of that in z. With s the sum of |x| + |y| over the corners, an edge function is
/// off by less than 2 slack (s + slack), rounding of its products included; kEdgeError leaves a
/// quarter in reserve. The hit's weights are off by so much over the sum of the edge functions, its
/// distance by that share of the triangle's depth; leaf-inl.h has the rest. Where corners are
/// quantised, `slack` is greater by as much as they are off.
struct FloatRay {
    static constexpr float kEdgeError = 2.5F;

    alignas(16) float inverse_near[4];
    alignas(16) float offset_near[4];
    alignas(16) float inverse_far[4];
    alignas(16) float offset_far[4];
    std::uint32_t near_plane[3], far_plane[3];  ///< first of the eight in WideNode::planes
    int order_shift;                            ///< of WideNode::order

    std::uint32_t axis[3];  ///< the last is the direction's largest component
    float origin[3];        ///< along these axes
    float shear_x, shear_y;
    float inverse_depth;  ///< t per metre along the last axis
    float slack;          ///< metres
    float t_max;          ///< rounded up
    float t_max_inside;   ///< rounded down
};

}  // namespace earshot::bvh
