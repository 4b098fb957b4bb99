// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/assert.h"
#include "earshot/bvh/tree.h"

#include <span>
#include <vector>

namespace bench {

/// The rebuild criterion of Lauterbach 2010, section 4.2: rebuild when the areas of inner nodes
/// over those of their children have grown by 40 % on average. All nodes count alike, however
/// seldom a ray visits them: docs/algorithms/bvh-deformation.md says what that means.
class AreaRatioRule {
public:
    static constexpr double kThreshold = 0.40;

    /// Remembers each inner node's area over the sum of its children's.
    explicit AreaRatioRule(const earshot::bvh::Tree& fresh) {
        ratios_.reserve(fresh.nodes().size());
        for (const Node& node : fresh.nodes()) {
            ratios_.push_back(area_ratio(fresh.nodes(), node));
        }
    }

    /// The mean growth of these ratios since. Precondition: the tree is the same but for refits.
    double growth(const earshot::bvh::Tree& refitted) const {
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

private:
    using Node = earshot::bvh::Node;

    /// 0 where the children have no area.
    static float area_ratio(std::span<const Node> nodes, const Node& node) {
        if (node.is_leaf()) {
            return 0.0F;
        }
        const double children =
            nodes[node.first].box.half_area() + nodes[node.first + 1].box.half_area();
        return children > 0.0 ? static_cast<float>(node.box.half_area() / children) : 0.0F;
    }

    std::vector<float> ratios_;  // per node; 0 for leaves
};

}  // namespace bench
