// SPDX-License-Identifier: MIT
#include "earshot/bvh/aging.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

/// 0 where the children have no area.
float area_ratio(std::span<const Node> nodes, const Node& node) {
    if (node.is_leaf()) {
        return 0.0F;
    }
    const double below = nodes[node.first].box.half_area() + nodes[node.first + 1].box.half_area();
    return below > 0.0 ? static_cast<float>(node.box.half_area() / below) : 0.0F;
}

}  // namespace

double expected_steps(const WideTree& tree, Executor& executor) {
    const double whole = tree.box().half_area();
    if (tree.nodes().empty()) {
        return 0.0;
    }
    constexpr std::size_t kGrain = 1024;
    std::vector<double> sums(chunk_count(tree.nodes().size(), kGrain), 0.0);
    executor.for_each(tree.nodes().size(), kGrain, [&](std::size_t begin, std::size_t end) {
        double sum = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
            const WideNode& node = tree.nodes()[i];
            for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
                sum += node.child[slot] == kNoChild ? 0.0 : slot_box(node, slot).half_area();
            }
        }
        sums[begin / kGrain] = sum;
    });
    double total = 0.0;
    for (const double sum : sums) {
        total += sum;
    }
    return whole > 0.0 ? 1.0 + total / whole : static_cast<double>(tree.nodes().size());
}

AreaRatioRule::AreaRatioRule(const Tree& fresh) {
    ratios_.reserve(fresh.nodes().size());
    for (const Node& node : fresh.nodes()) {
        ratios_.push_back(area_ratio(fresh.nodes(), node));
    }
}

double AreaRatioRule::growth(const Tree& refitted) const {
    EARSHOT_ASSERT(refitted.nodes().size() == ratios_.size());
    double sum = 0.0;
    std::size_t inner = 0;
    for (std::size_t i = 0; i < ratios_.size(); ++i) {
        const Node& node = refitted.nodes()[i];
        if (!node.is_leaf()) {
            sum += static_cast<double>(area_ratio(refitted.nodes(), node)) -
                   static_cast<double>(ratios_[i]);
            ++inner;
        }
    }
    return inner > 0 ? sum / static_cast<double>(inner) : 0.0;
}

}  // namespace earshot::bvh
