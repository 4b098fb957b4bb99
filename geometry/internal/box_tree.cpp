// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/box_tree.h"

#include <glm/common.hpp>

#include <numeric>

namespace earshot::geometry {

BoxTree::BoxTree(std::span<const Box> boxes)
    : boxes_(boxes.begin(), boxes.end()), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (!boxes.empty()) {
        build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
    }
}

void BoxTree::build(std::span<const Box> boxes, std::uint32_t begin, std::uint32_t end) {
    constexpr std::uint32_t kLeafSize = 4;
    Box box = boxes[order_[begin]];
    for (std::uint32_t i = begin + 1; i < end; ++i) {
        box.lower = glm::min(box.lower, boxes[order_[i]].lower);
        box.upper = glm::max(box.upper, boxes[order_[i]].upper);
    }
    const std::size_t node = nodes_.size();
    nodes_.push_back({box, begin, end, 0});
    if (end - begin <= kLeafSize) {
        return;
    }
    const Vec3 size = box.upper - box.lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::uint32_t i) { return order_.begin() + i; };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
        const double left = boxes[a].lower[axis] + boxes[a].upper[axis];
        const double right = boxes[b].lower[axis] + boxes[b].upper[axis];
        return left != right ? left < right : a < b;
    });
    build(boxes, begin, middle);
    nodes_[node].right = static_cast<std::uint32_t>(nodes_.size());
    build(boxes, middle, end);
}

std::vector<std::uint32_t> BoxTree::overlapping(const Box& query) const {
    std::vector<std::uint32_t> found;
    std::vector<std::uint32_t> stack;
    if (!nodes_.empty()) {
        stack.push_back(0);
    }
    while (!stack.empty()) {
        const std::uint32_t index = stack.back();
        stack.pop_back();
        const Node& node = nodes_[index];
        if (!node.box.overlaps(query)) {
            continue;
        }
        if (node.right != 0) {
            stack.push_back(node.right);
            stack.push_back(index + 1);
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            if (boxes_[order_[i]].overlaps(query)) {
                found.push_back(order_[i]);
            }
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace earshot::geometry
