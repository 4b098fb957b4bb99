// SPDX-License-Identifier: MIT
#include "earshot/bvh/grouped_tree.h"

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <set>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Aabb;
using geometry::Vec3;

/// Groups of boxes around a place each, some of them empty, and how they move.
struct Groups {
    std::vector<std::size_t> ends;
    std::vector<std::uint32_t> group_of;
    std::vector<Vec3> places, velocities;

    explicit Groups(const std::vector<std::size_t>& sizes) {
        support::Dice dice(7);
        for (std::uint32_t group = 0; group < sizes.size(); ++group) {
            const Vec3 middle(dice.between(-9, 9), dice.between(-9, 9), dice.between(-9, 9));
            const Vec3 velocity(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
            for (std::size_t i = 0; i < sizes[group]; ++i) {
                places.push_back(
                    middle + Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)));
                velocities.push_back(3.0 * velocity + Vec3(dice.between(-1, 1),
                                                           dice.between(-1, 1),
                                                           dice.between(-1, 1)));
                group_of.push_back(group);
            }
            ends.push_back(places.size());
        }
    }

    std::vector<Aabb> boxes_at(double time) const {
        std::vector<Aabb> boxes(places.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Vec3 place = places[i] + time * velocities[i];
            boxes[i].include(place - Vec3(0.05));
            boxes[i].include(place + Vec3(0.05));
        }
        return boxes;
    }
};

/// Checks that every primitive is in one leaf, that boxes contain what is below them, that siblings
/// follow their parent, and that the nodes of a group are one subtree.
void expect_valid(const Tree& tree, const Groups& groups, const std::vector<Aabb>& boxes) {
    std::vector<std::uint32_t> sorted(tree.primitives().begin(), tree.primitives().end());
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted.size(), boxes.size());
    for (std::uint32_t i = 0; i < sorted.size(); ++i) {
        ASSERT_EQ(sorted[i], i);
    }
    const std::vector<std::uint32_t> of_node = groups_of_nodes(tree, groups.ends);
    ASSERT_EQ(of_node.size(), tree.nodes().size());
    std::set<std::uint32_t> roots;  // groups whose root was seen
    for (std::uint32_t i = 0; i < of_node.size(); ++i) {
        const Node& node = tree.nodes()[i];
        Aabb box;
        if (node.is_leaf()) {
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
                const std::uint32_t primitive = tree.primitives()[k];
                box.include(boxes[primitive]);
                EXPECT_EQ(groups.group_of[primitive], of_node[i]);
            }
        } else {
            ASSERT_GT(node.first, i);
            for (const std::uint32_t child : {node.first, node.first + 1}) {
                box.include(tree.nodes()[child].box);
                if (of_node[i] == kMixedGroups && of_node[child] != kMixedGroups) {
                    EXPECT_TRUE(roots.insert(of_node[child]).second) << "a group is torn apart";
                }
            }
        }
        EXPECT_EQ(box, node.box);
    }
}

TEST(GroupedTree, GivesEveryGroupASubtree) {
    for (const std::vector<std::size_t>& sizes :
         {std::vector<std::size_t>{40, 0, 1, 7, 300, 2, 0}, {5}, {0, 0}, {1, 1, 1}}) {
        const Groups groups(sizes);
        Executor two(2);
        const auto boxes = groups.boxes_at(0.0);
        const Tree tree = build_grouped(boxes, groups.ends, {}, two);
        expect_valid(tree, groups, boxes);
    }
}

TEST(GroupedTree, StaysOneWhereSubtreesAreReinserted) {
    const Groups groups({60, 80, 3, 90, 0, 1, 70, 120, 45, 2, 30});
    Tree tree = build_grouped(groups.boxes_at(0.0), groups.ends);
    std::size_t reinsertions = 0;
    for (int step = 1; step <= 10; ++step) {
        const auto boxes = groups.boxes_at(0.5 * step);
        tree.refit(boxes);
        const auto of_node = groups_of_nodes(tree, groups.ends);
        const double before = sah_cost(tree);
        reinsertions +=
            optimise_by_reinsertion(
                tree, {.max_iterations = 3, .batch_size_ratio = 0.3, .group_of_node = of_node})
                .reinsertions;
        EXPECT_LE(sah_cost(tree), before);
        expect_valid(tree, groups, boxes);
    }
    EXPECT_GT(reinsertions, 20U);
}

TEST(GroupedTree, IsFollowedByRefitRepairAndRebuild) {
    const Groups groups({200, 300, 0, 20, 150, 1});
    for (const double queries : {0.0, 500.0, 1e4, 1e9}) {
        DeformableBvh bvh(groups.boxes_at(0.0),
                          {.queries_per_update = queries, .group_ends = groups.ends});
        std::set<UpdateAction> actions;
        for (int step = 1; step <= 12; ++step) {
            const auto boxes = groups.boxes_at(0.3 * step);
            const std::uint64_t version = bvh.version();
            const UpdateReport report = bvh.update(boxes);
            actions.insert(report.action);
            EXPECT_DOUBLE_EQ(report.sah_cost, sah_cost(bvh.binary_tree()));
            EXPECT_LE(report.sah_cost, report.sah_cost_after_refit);
            EXPECT_TRUE(report.action != UpdateAction::refit || version == bvh.version());
            expect_valid(bvh.binary_tree(), groups, boxes);
        }
        EXPECT_EQ(actions != std::set{UpdateAction::refit}, queries > 0.0) << queries;
    }
}

TEST(GroupedTree, RebuildsTheLaterTheMoreAChangeOfTopologyCosts) {
    const Groups groups({400, 400});
    int cheap = 0, dear = 0;
    DeformableBvh one(groups.boxes_at(0.0), {.queries_per_update = 1e4});
    DeformableBvh other(groups.boxes_at(0.0), {.queries_per_update = 1e4, .topology_cost = 1e5});
    for (int step = 1; step <= 12; ++step) {
        const auto boxes = groups.boxes_at(0.3 * step);
        cheap += one.update(boxes).action == UpdateAction::refit ? 0 : 1;
        dear += other.update(boxes).action == UpdateAction::refit ? 0 : 1;
    }
    EXPECT_GT(cheap, 0);
    EXPECT_EQ(dear, 0);
    // As many queries as visit that many nodes of this tree.
    other.expect_node_visits(1e9 * sah_cost(other.binary_tree()));
    EXPECT_NE(other.update(groups.boxes_at(30.0)).action, UpdateAction::refit);
}

TEST(GroupedTree, MayHaveNoBoxes) {
    DeformableBvh none;
    EXPECT_EQ(none.update(std::span<const Aabb>{}).action, UpdateAction::refit);
    EXPECT_TRUE(none.binary_tree().nodes().empty());
}

}  // namespace
}  // namespace earshot::bvh
