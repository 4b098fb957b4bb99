// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/point_tree.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace earshot::geometry {
namespace {

// A radius grown by 2^-10 of itself takes in all rounding of the box tests, which is below 2^-50 of
// the coordinates: the radius is at least 2^-40 of them.
constexpr double kGrowth = 1.0 + 0x1p-10;
constexpr std::uint32_t kLeafSize = 8;
// Median splits divide 2^32 points at most 32 times; depth first, the stack holds one node of each
// level.
constexpr std::size_t kStackSize = 40;

/// False only if the segment stays farther than `radius` from the box. Separating axes of a segment
/// and a box (Gottschalk 2000; Ericson 2005, section 5.3.3), with the box grown by the radius.
bool may_touch(const Vec3& centre,
               const Vec3& half,
               double radius,
               const Vec3& middle,
               const Vec3& half_extent) {
    const Vec3 h = half + Vec3(radius);
    const Vec3 m = middle - centre;
    const Vec3 r = glm::abs(half_extent);
    const Vec3 cross = glm::abs(glm::cross(m, half_extent));
    return std::abs(m.x) <= h.x + r.x && std::abs(m.y) <= h.y + r.y && std::abs(m.z) <= h.z + r.z &&
           cross.x <= h.y * r.z + h.z * r.y && cross.y <= h.x * r.z + h.z * r.x &&
           cross.z <= h.x * r.y + h.y * r.x;
}

}  // namespace

PointTree::PointTree(std::vector<Point> points) : points_(std::move(points)) {
    if (!points_.empty()) {
        build(0, static_cast<std::uint32_t>(points_.size()));
    }
}

void PointTree::build(std::uint32_t begin, std::uint32_t end) {
    Vec3 lower = points_[begin].position;
    Vec3 upper = lower;
    for (std::uint32_t i = begin; i < end; ++i) {
        lower = glm::min(lower, points_[i].position);
        upper = glm::max(upper, points_[i].position);
    }
    const std::size_t node = nodes_.size();
    const Vec3 centre = 0.5 * lower + 0.5 * upper;
    nodes_.push_back({centre, glm::max(upper - centre, centre - lower), begin, end, 0});
    if (end - begin <= kLeafSize) {
        return;
    }
    const Vec3 size = upper - lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        points_.begin() + begin,
        points_.begin() + middle,
        points_.begin() + end,
        [axis](const Point& a, const Point& b) { return a.position[axis] < b.position[axis]; });
    build(begin, middle);
    nodes_[node].right = static_cast<std::uint32_t>(nodes_.size());
    build(middle, end);
}

void PointTree::near_segment(const Segment& segment,
                             double radius,
                             const std::function<void(const Point&)>& visit) const {
    if (nodes_.empty()) {
        return;
    }
    const Vec3 middle = 0.5 * segment.from + 0.5 * segment.to;
    const Vec3 half_extent = 0.5 * segment.to - 0.5 * segment.from;
    std::array<std::uint32_t, kStackSize> stack{};
    std::size_t count = 1;  // the root, 0
    while (count > 0) {
        const std::uint32_t index = stack[--count];
        const Node& node = nodes_[index];
        if (!may_touch(node.centre, node.half, radius * kGrowth, middle, half_extent)) {
            continue;
        }
        if (node.right != 0) {
            stack[count++] = node.right;
            stack[count++] = index + 1;
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            visit(points_[i]);
        }
    }
}

}  // namespace earshot::geometry
