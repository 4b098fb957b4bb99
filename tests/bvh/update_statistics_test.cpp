// SPDX-License-Identifier: MIT
#include "earshot/bvh/update_statistics.h"

#include <gtest/gtest.h>

namespace earshot::bvh {
namespace {

TEST(UpdateStatistics, CountsActionsByKindAndAddsUp) {
    UpdateStatistics some, more;
    some.count(UpdateAction::refit);
    some.count(UpdateAction::refit);
    some.count(UpdateAction::rebuild);
    more.count(UpdateAction::repair);
    more.count(UpdateAction::refit);
    some += more;
    EXPECT_EQ(some, (UpdateStatistics{.refits = 3, .repairs = 1, .rebuilds = 1}));
}

}  // namespace
}  // namespace earshot::bvh
