// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"

#include <string>
#include <vector>

namespace bench {

/// Rays of one kind, the same for every contender. One of the two lists is empty.
struct RaySet {
    std::string name;
    std::vector<earshot::geometry::Ray> rays;          ///< for closest hits
    std::vector<earshot::geometry::Segment> segments;  ///< for any hit
};

/// `count` rays at most of each kind: `camera` (a square picture in tiles of 8 x 8, from the middle
/// of a room or from outside an object), `diffuse` (one bounce, cosine-distributed, from what the
/// camera sees), `ao` (short segments from there, a tenth of the diagonal), `random` (from a point
/// in the box in any direction), `los` (segments between two points in the box).
std::vector<RaySet> make_ray_sets(const earshot::geometry::MeshView& mesh,
                                  std::size_t count,
                                  bool from_inside);

}  // namespace bench
