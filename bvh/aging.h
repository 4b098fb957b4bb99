// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

#include <vector>

namespace earshot::bvh {

/// Expected steps of a random ray that meets the box: nodes and leaves, each weighed by its chance
/// of being met (its area over the box's; MacDonald and Booth 1990). It grows as refits let boxes
/// overlap. Reads nodes only, a twentieth of what a refit touches; the same bits for any executor.
/// 0 for an empty tree.
double expected_steps(const WideTree& tree, Executor& executor = Executor::serial());

/// The rule of Lauterbach 2010, section 4.2: rebuild when the boxes of inner nodes have grown, on
/// average, by 40 % of what their children's boxes have. All nodes count alike, however seldom a
/// ray meets them: see docs/algorithms/bvh-deformation.md for what that means.
class AreaRatioRule {
public:
    static constexpr double kThreshold = 0.40;

    /// Remembers each inner node's area over the sum of its children's.
    explicit AreaRatioRule(const Tree& fresh);

    /// The mean growth of these ratios since. Precondition: the tree is the same but for refits.
    double growth(const Tree& refitted) const;

private:
    std::vector<float> ratios_;  // per node; 0 for leaves
};

}  // namespace earshot::bvh
