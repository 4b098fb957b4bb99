// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/receiver_tree.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

constexpr std::uint32_t kBallsPerLeaf = 4;
/// Spheres are this much larger, relative, than what they hold: far above rounding.
constexpr double kPadding = 1e-6;

}  // namespace

ReceiverTree::ReceiverTree(std::span<const Ball> balls) : order_(balls.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (!balls.empty()) {
        build(balls, 0, static_cast<std::uint32_t>(balls.size()));
    }
}

// Halves the balls along the longest side of their box until few are left.
void ReceiverTree::build(std::span<const Ball> balls, std::uint32_t begin, std::uint32_t end) {
    Vec3 low(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (std::uint32_t k = begin; k < end; ++k) {
        low = glm::min(low, balls[order_[k]].centre);
        high = glm::max(high, balls[order_[k]].centre);
    }
    const std::size_t index = nodes_.size();
    Node node{.centre = 0.5 * (low + high)};
    for (std::uint32_t k = begin; k < end; ++k) {
        const Ball& ball = balls[order_[k]];
        node.radius = std::max(node.radius, glm::length(ball.centre - node.centre) + ball.radius);
    }
    node.radius *= 1.0 + kPadding;
    const bool is_leaf = end - begin <= kBallsPerLeaf;
    if (is_leaf) {
        node.begin = begin;
        node.end = end;
    }
    nodes_.push_back(node);
    if (!is_leaf) {
        const Vec3 extent = high - low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                         : extent.y >= extent.z                       ? 1
                                                                      : 2;
        const std::uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin,
                         order_.begin() + middle,
                         order_.begin() + end,
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double left = balls[a].centre[axis];
                             const double right = balls[b].centre[axis];
                             return left < right || (left == right && a < b);
                         });
        build(balls, begin, middle);
        build(balls, middle, end);
    }
    nodes_[index].next = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace earshot::propagation
