// SPDX-License-Identifier: MIT
#include "earshot/bvh/update_policy.h"

#include <gtest/gtest.h>

namespace earshot::bvh {
namespace {

constexpr UpdatePolicy::ActionCosts kCosts = {
    .repair = 60.0, .rebuild = 100.0, .restore = 40.0, .look_up = 10.0};
constexpr double kNewCost = 10.0;  // of a new tree

UpdateReport outcome(UpdateAction action, double before, double after) {
    return {.action = action, .sah_cost_after_refit = before, .sah_cost = after};
}

// 10 queries an update, each 2 over 10: 20 an update, so that a repair of 60 is due at the third.
TEST(UpdatePolicy, RepairsWhenTheExcessHasAddedUpToTheCost) {
    UpdatePolicy policy(kCosts, kNewCost);
    EXPECT_EQ(policy.choose(12.0, 10.0), UpdateAction::refit);
    EXPECT_EQ(policy.choose(12.0, 10.0), UpdateAction::refit);
    EXPECT_EQ(policy.choose(12.0, 10.0), UpdateAction::repair);
    EXPECT_TRUE(policy.is_repair_worthwhile(12.0, 10.0));
    policy.record_outcome(outcome(UpdateAction::repair, 12.0, 10.0));
    EXPECT_EQ(policy.choose(12.0, 10.0), UpdateAction::refit);
}

TEST(UpdatePolicy, DoesNothingWithoutQueriesOrExcess) {
    UpdatePolicy policy(kCosts, kNewCost);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(policy.choose(1000.0, 0.0), UpdateAction::refit);
        EXPECT_EQ(policy.choose(9.0, 1e9), UpdateAction::refit);
    }
}

// A repair from 12 to 11.8 leaves nine tenths of an excess of 60, 54: with the repair's 60 more
// than the rebuild's 100. Repairs are tried again after four rebuilds.
TEST(UpdatePolicy, GivesUpRepairsThatLeaveTooMuch) {
    UpdatePolicy policy(kCosts, kNewCost);
    EXPECT_EQ(policy.choose(12.0, 30.0), UpdateAction::repair);
    EXPECT_FALSE(policy.is_repair_worthwhile(12.0, 11.8));
    policy.record_outcome(outcome(UpdateAction::rebuild, 12.0, 10.0));
    for (int rebuild = 2; rebuild <= 4; ++rebuild) {
        EXPECT_EQ(policy.choose(12.0, 49.0), UpdateAction::refit);
        EXPECT_EQ(policy.choose(12.0, 1.0), UpdateAction::rebuild);
        policy.record_outcome(outcome(UpdateAction::rebuild, 12.0, 10.0));
    }
    EXPECT_EQ(policy.choose(12.0, 30.0), UpdateAction::repair);
}

// An update's excess of more than two rebuilds: what a repair left of it would cost too much.
TEST(UpdatePolicy, RebuildsWhereTheExcessIsLarge) {
    UpdatePolicy policy(kCosts, kNewCost);
    EXPECT_EQ(policy.choose(12.0, 101.0), UpdateAction::rebuild);
}

// One repair, then a rebuild to know what a new tree costs; twice as many repairs after it, unless
// it is much better than they were.
TEST(UpdatePolicy, RebuildsAfterSomeRepairs) {
    for (const double rebuilt : {9.8, 9.0}) {
        UpdatePolicy policy(kCosts, kNewCost);
        policy.choose(12.0, 50.0);
        policy.record_outcome(outcome(UpdateAction::repair, 12.0, 10.0));
        EXPECT_EQ(policy.choose(12.0, 50.0), UpdateAction::rebuild);
        policy.record_outcome(outcome(UpdateAction::rebuild, 12.0, rebuilt));
        EXPECT_EQ(policy.choose(12.0, 50.0), UpdateAction::repair);
        policy.record_outcome(outcome(UpdateAction::repair, 12.0, rebuilt));
        EXPECT_EQ(policy.choose(12.0, 50.0),
                  rebuilt > 9.5 ? UpdateAction::repair : UpdateAction::rebuild);
    }
}

// A rebuild that gains 1 % of the cost is due again after twice its cost in excess.
TEST(UpdatePolicy, BacksOffFromWhatGainsTooLittle) {
    UpdatePolicy policy(kCosts, kNewCost);
    policy.choose(12.0, 100.0);
    policy.record_outcome(outcome(UpdateAction::rebuild, 12.0, 11.9));
    EXPECT_EQ(policy.choose(12.9, 100.0), UpdateAction::refit);
    EXPECT_NE(policy.choose(12.9, 100.0), UpdateAction::refit);
}

// A look-up of 10 is due when queries have cost 1,000, a hundred times as much.
TEST(UpdatePolicy, LooksUpTheKeptTopologyForASmallShareOfTheQueries) {
    UpdatePolicy policy(kCosts, kNewCost);
    EXPECT_EQ(policy.choose(10.0, 90.0), UpdateAction::refit);
    EXPECT_FALSE(policy.is_look_up_due(UpdateAction::refit));
    EXPECT_EQ(policy.choose(10.0, 10.0), UpdateAction::refit);
    EXPECT_TRUE(policy.is_look_up_due(UpdateAction::refit));
    // At twice the cost: nine times as seldom.
    EXPECT_FALSE(policy.should_restore(UpdateAction::refit, 10.0, 20.0));
    policy.choose(10.0, 890.0);
    EXPECT_FALSE(policy.is_look_up_due(UpdateAction::refit));
    policy.choose(10.0, 20.0);
    EXPECT_TRUE(policy.is_look_up_due(UpdateAction::refit));
}

// 100 queries that the kept topology would answer for 9.75 instead of 10: 25 an update, and 40 is
// what it costs to take over.
TEST(UpdatePolicy, RestoresTheKeptTopologyWhenItsSavingsHaveAddedUp) {
    UpdatePolicy policy(kCosts, kNewCost);
    policy.choose(10.0, 100.0);
    EXPECT_FALSE(policy.should_restore(UpdateAction::refit, 10.0, 9.75));
    policy.choose(10.0, 100.0);
    EXPECT_TRUE(policy.should_restore(UpdateAction::refit, 10.0, 9.75));
}

TEST(UpdatePolicy, RestoresTheKeptTopologyInsteadOfAnActionIfItIsAsGood) {
    for (const double kept : {10.2, 10.8}) {
        UpdatePolicy policy(kCosts, kNewCost);
        EXPECT_EQ(policy.choose(12.0, 30.0), UpdateAction::repair);
        EXPECT_TRUE(policy.is_look_up_due(UpdateAction::repair));
        EXPECT_EQ(policy.should_restore(UpdateAction::repair, 12.0, kept), kept < 10.3);
    }
}

}  // namespace
}  // namespace earshot::bvh
