// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/point_groups.h"

#include <algorithm>
#include <cstddef>

namespace earshot::visibility {

using geometry::Aabb;
using geometry::Vec3;

namespace {

// A point that moves gets a box for as many steps like its last one.
constexpr double kStepsAhead = 8.0;

bool contains(const Aabb& box, const Vec3& point) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        if (!(point[axis] >= box.lower[k] && point[axis] <= box.upper[k])) {
            return false;
        }
    }
    return true;
}

bool contains(const Aabb& outer, const Aabb& inner) noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
        if (inner.lower[k] < outer.lower[k] || inner.upper[k] > outer.upper[k]) {
            return false;
        }
    }
    return true;
}

Aabb box_of(const Vec3& point) noexcept {
    Aabb box;
    box.include(point);
    return box;
}

}  // namespace

bool PointGroups::update(std::span<const Vec3> points, Executor& executor) {
    if (points.size() != points_.size()) {
        rebuild(points, executor);
        return false;
    }
    if (std::equal(points.begin(), points.end(), points_.begin())) {
        return true;
    }
    bool has_left = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!contains(boxes_[i], points[i])) {
            has_left = true;
            const Vec3 step = points[i] - points_[i];
            boxes_[i] = box_of(points[i]);
            boxes_[i].include(points[i] + kStepsAhead * step);
        }
    }
    points_.assign(points.begin(), points.end());
    if (!has_left) {
        return true;
    }
    old_boxes_.clear();
    for (const bvh::Node& node : nodes()) {
        old_boxes_.push_back(node.box);
    }
    bvh_.update(boxes_, executor);
    if (bvh_.version() != topology_) {
        list_points();
        return false;
    }
    // Children stand after their parents.
    std::vector<std::uint8_t> has_grown(old_boxes_.size(), 0);
    for (std::size_t index = old_boxes_.size(); index-- > 0;) {
        const bvh::Node& node = nodes()[index];
        has_grown[index] = !contains(old_boxes_[index], node.box) ||
                                   (!node.is_leaf() &&
                                    (has_grown[node.first] != 0 || has_grown[node.first + 1] != 0))
                               ? 1
                               : 0;
        versions_[index] += has_grown[index];
    }
    return true;
}

void PointGroups::rebuild(std::span<const Vec3> points, Executor& executor) {
    points_.assign(points.begin(), points.end());
    boxes_.clear();
    for (const Vec3& point : points) {
        boxes_.push_back(box_of(point));
    }
    bvh_ =
        bvh::DeformableBvh(boxes_,
                           {.build = {.builder = bvh::Builder::spatial_median, .max_leaf_size = 1},
                            .queries_per_update = static_cast<double>(points.size())},
                           executor);
    list_points();
}

void PointGroups::list_points() {
    topology_ = bvh_.version();
    const bvh::Tree& tree = bvh_.binary_tree();
    order_.clear();
    begin_.assign(nodes().size(), 0);
    end_.assign(nodes().size(), 0);
    versions_.assign(nodes().size(), 0);
    std::vector<std::uint32_t> stack;
    if (!nodes().empty()) {
        stack.push_back(0);
    }
    while (!stack.empty()) {
        const std::uint32_t index = stack.back();
        stack.pop_back();
        const bvh::Node& node = nodes()[index];
        begin_[index] = static_cast<std::uint32_t>(order_.size());
        if (node.is_leaf()) {
            const auto first = tree.primitives().begin() + node.first;
            order_.insert(order_.end(), first, first + node.count);
            end_[index] = static_cast<std::uint32_t>(order_.size());
        } else {
            stack.push_back(node.first + 1);
            stack.push_back(node.first);
        }
    }
    // Children stand after their parents.
    for (std::size_t index = nodes().size(); index-- > 0;) {
        if (!nodes()[index].is_leaf()) {
            end_[index] = end_[nodes()[index].first + 1];
        }
    }
    units_.clear();
    if (!nodes().empty()) {
        stack.push_back(0);
    }
    while (!stack.empty()) {
        const std::uint32_t index = stack.back();
        stack.pop_back();
        const bvh::Node& node = nodes()[index];
        if (node.is_leaf() || end_[index] - begin_[index] <= kMaxUnitPoints) {
            units_.push_back(index);
        } else {
            stack.push_back(node.first + 1);
            stack.push_back(node.first);
        }
    }
}

}  // namespace earshot::visibility
