// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace earshot::geometry {

/// A balanced tree of boxes around points (Bentley 1975, split at the median), to find the points
/// near a segment. It adapts to meshes in which dense detail stands beside large walls.
class PointTree {
public:
    struct Point {
        Vec3 position{0.0};
        VertexId vertex = 0;
    };

    /// O(n log n).
    explicit PointTree(std::vector<Point> points);

    /// Calls visit(point) for every point within `radius` of the segment, and for some others.
    /// Precondition: the radius is at least 2^-40 of the largest coordinate.
    void near_segment(const Segment& segment,
                      double radius,
                      const std::function<void(const Point&)>& visit) const;

private:
    struct Node {
        Vec3 centre{0.0};
        Vec3 half{0.0};
        std::uint32_t begin = 0, end = 0;  // of points_
        std::uint32_t right = 0;           // second child; the first follows its parent; 0: a leaf
    };

    void build(std::uint32_t begin, std::uint32_t end);

    std::vector<Point> points_;
    std::vector<Node> nodes_;
};

}  // namespace earshot::geometry
