// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/box_tree.h"

#include <glm/common.hpp>

#include <array>
#include <cstddef>
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

template <typename Visit>
void BoxTree::visit_overlapping(const Box& query, const Visit& visit) const {
    // Median splits divide 2^32 boxes at most 32 times; the stack holds one node of each level.
    std::array<std::uint32_t, 40> stack{};
    std::size_t count = nodes_.empty() ? 0 : 1;
    while (count > 0) {
        const std::uint32_t index = stack[--count];
        const Node& node = nodes_[index];
        if (!node.box.overlaps(query)) {
            continue;
        }
        if (node.right != 0) {
            stack[count++] = node.right;
            stack[count++] = index + 1;
            continue;
        }
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            if (boxes_[order_[i]].overlaps(query) && !visit(order_[i])) {
                return;
            }
        }
    }
}

std::vector<std::uint32_t> BoxTree::overlapping(const Box& query) const {
    std::vector<std::uint32_t> found;
    visit_overlapping(query, [&](std::uint32_t box) {
        found.push_back(box);
        return true;
    });
    std::sort(found.begin(), found.end());
    return found;
}

bool BoxTree::any_overlapping(const Box& query) const {
    bool is_any = false;
    visit_overlapping(query, [&](std::uint32_t) {
        is_any = true;
        return false;
    });
    return is_any;
}

}  // namespace earshot::geometry
