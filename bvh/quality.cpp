// SPDX-License-Identifier: MIT
#include "earshot/bvh/quality.h"

#include <algorithm>
#include <utility>

namespace earshot::bvh {

double sah_cost(const Tree& tree, double traversal_cost) noexcept {
    if (tree.nodes().empty()) {
        return 0.0;
    }
    const double root_area = tree.nodes().front().box.half_area();
    double cost = 0.0;
    for (const Node& node : tree.nodes()) {
        const double probability = root_area > 0.0 ? node.box.half_area() / root_area : 1.0;
        cost += probability * (node.is_leaf() ? static_cast<double>(node.count) : traversal_cost);
    }
    return cost;
}

Quality quality(const Tree& tree, double traversal_cost) {
    Quality result = {.nodes = tree.nodes().size(),
                      .sah_cost = sah_cost(tree, traversal_cost),
                      .bytes = tree.nodes().size_bytes() + tree.primitives().size_bytes()};
    std::vector<std::pair<std::uint32_t, std::size_t>> open;
    if (!tree.nodes().empty()) {
        open.emplace_back(0U, 0U);
    }
    while (!open.empty()) {
        const auto [index, depth] = open.back();
        open.pop_back();
        const Node& node = tree.nodes()[index];
        if (node.is_leaf()) {
            ++result.leaves;
            result.depth = std::max(result.depth, depth);
        } else {
            open.emplace_back(node.first, depth + 1);
            open.emplace_back(node.first + 1, depth + 1);
        }
    }
    return result;
}

}  // namespace earshot::bvh
