// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/bvtt_front.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Aabb;
using geometry::Vec3;
using support::Dice;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// Lists the pairs of primitives whose boxes overlap.
class Lister {
public:
    Lister(const bvh::Tree& tree, const std::vector<Aabb>& boxes) : tree_(&tree), boxes_(&boxes) {}

    bool culls(std::uint32_t, std::uint32_t) const { return false; }

    std::uint64_t test_leaves(std::uint32_t a, std::uint32_t b) {
        const bvh::Node& left = tree_->nodes()[a];
        const bvh::Node& right = tree_->nodes()[b];
        for (std::uint32_t i = left.first; i < left.first + left.count; ++i) {
            for (std::uint32_t k = a == b ? i + 1 : right.first; k < right.first + right.count;
                 ++k) {
                const std::uint32_t one = tree_->primitives()[i], other = tree_->primitives()[k];
                if (SelfTraversal<Lister>::overlap((*boxes_)[one], (*boxes_)[other])) {
                    pairs.emplace_back(std::min(one, other), std::max(one, other));
                }
            }
        }
        return 0;
    }

    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;

private:
    const bvh::Tree* tree_;
    const std::vector<Aabb>* boxes_;
};

struct Traversed {
    Pairs pairs;
    std::uint64_t box_tests = 0;
};

Traversed traverse(BvttFront& front,
                   const bvh::Tree& tree,
                   const std::vector<Aabb>& boxes,
                   bool track,
                   Executor& executor) {
    Traversed result;
    result.box_tests = front.traverse(
        tree,
        track,
        std::numeric_limits<std::size_t>::max(),
        executor,
        [&] { return Lister(tree, boxes); },
        [&](const Lister& lister) {
            for (const auto& pair : lister.pairs) {
                EXPECT_TRUE(result.pairs.insert(pair).second) << "a pair was listed twice";
            }
        });
    return result;
}

Pairs all_pairs(const std::vector<Aabb>& boxes) {
    Pairs pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        for (std::uint32_t k = i + 1; k < boxes.size(); ++k) {
            if (SelfTraversal<Lister>::overlap(boxes[i], boxes[k])) {
                pairs.insert({i, k});
            }
        }
    }
    return pairs;
}

/// Boxes that swing about their places, so that they come together and part.
std::vector<Aabb> boxes_at(double time, std::size_t count) {
    std::vector<Aabb> boxes(count);
    Dice dice(3);
    for (Aabb& box : boxes) {
        const Vec3 place(dice.between(-6, 6), dice.between(-6, 6), dice.between(-6, 6));
        const Vec3 toward(dice.between(-6, 6), dice.between(-6, 6), dice.between(-6, 6));
        const Vec3 middle = place + time * (toward - place) * 0.9;
        box.include(middle - Vec3(0.3));
        box.include(middle + Vec3(0.3));
    }
    return boxes;
}

TEST(BvttFront, ListsWhatAllPairsDoWhileBoxesComeTogetherAndPart) {
    constexpr std::size_t kCount = 500;
    bvh::Tree tree = bvh::Tree::build(boxes_at(0.0, kCount));
    BvttFront kept, none;
    std::uint64_t with = 0, without = 0;
    for (int step = 0; step <= 40; ++step) {
        const double time = 0.5 - 0.5 * std::cos(0.3 * step);
        const auto boxes = boxes_at(time, kCount);
        tree.refit(boxes);
        Executor executor(1 + step % 3);
        const Pairs expected = all_pairs(boxes);
        const Traversed tracked = traverse(kept, tree, boxes, true, executor);
        const Traversed afresh = traverse(none, tree, boxes, false, executor);
        EXPECT_EQ(tracked.pairs, expected) << step;
        EXPECT_EQ(afresh.pairs, expected) << step;
        with += tracked.box_tests;
        without += afresh.box_tests;
    }
    EXPECT_LT(with, without);
}

TEST(BvttFront, MovesUpWhereBoxesHaveParted) {
    // Everything overlaps in the middle of the motion: the front grows to all pairs, and has to
    // shrink again.
    constexpr std::size_t kCount = 300;
    const auto boxes_in = [&](double size) {
        std::vector<Aabb> boxes(kCount);
        Dice dice(4);
        for (Aabb& box : boxes) {
            const Vec3 middle(dice.between(-6, 6), dice.between(-6, 6), dice.between(-6, 6));
            box.include(size * middle - Vec3(0.2));
            box.include(size * middle + Vec3(0.2));
        }
        return boxes;
    };
    bvh::Tree tree = bvh::Tree::build(boxes_in(1.0));
    BvttFront front, fresh;
    Executor& serial = Executor::serial();
    std::vector<std::uint64_t> tests;
    for (const double size : {1.0, 0.02, 1.0, 1.0}) {
        const auto boxes = boxes_in(size);
        tree.refit(boxes);
        const Traversed traversed = traverse(front, tree, boxes, true, serial);
        EXPECT_EQ(traversed.pairs, all_pairs(boxes));
        tests.push_back(traversed.box_tests);
    }
    EXPECT_GT(tests[1], kCount * (kCount - 1) / 2);
    // The last step begins where the front has moved up to: hardly deeper than one that never was
    // further down.
    const auto boxes = boxes_in(1.0);
    traverse(fresh, tree, boxes, true, serial);
    EXPECT_LE(tests[3], 2 * traverse(fresh, tree, boxes, true, serial).box_tests);
    EXPECT_LT(tests[3], tests[1] / 10);
}

TEST(BvttFront, HoldsAllPairsOfLeavesWhereAllBoxesOverlapAndFewerWhereNoneDo) {
    const auto size_of_front = [](double distance, std::size_t count) {
        std::vector<Aabb> boxes(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 middle(distance * static_cast<double>(i), 0.0, 0.0);
            boxes[i].include(middle - Vec3(1.0));
            boxes[i].include(middle + Vec3(1.0));
        }
        BvttFront front;
        const bvh::Tree tree = bvh::Tree::build(boxes, {.max_leaf_size = 1});
        traverse(front, tree, boxes, true, Executor::serial());
        return front.size();
    };
    // Every leaf against itself and against all others.
    EXPECT_EQ(size_of_front(0.0, 20), 20U * 21U / 2U);
    // Every leaf against itself, and a culled pair of siblings for every inner node.
    EXPECT_EQ(size_of_front(3.0, 20), 20U + 19U);
}

TEST(BvttFront, OfNoBoxesIsEmpty) {
    BvttFront front;
    EXPECT_TRUE(traverse(front, bvh::Tree(), {}, true, Executor::serial()).pairs.empty());
}

}  // namespace
}  // namespace earshot::collision
