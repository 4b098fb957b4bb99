// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace earshot {
namespace {

TEST(SimdTargets, EndWithScalarAndStandOnce) {
    const auto targets = simd_targets();
    ASSERT_FALSE(targets.empty());
    EXPECT_EQ(targets.back(), "scalar");
    auto sorted = targets;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::unique(sorted.begin(), sorted.end()), sorted.end());
}

TEST(SimdTargets, AreTheSameAfterOneWasChosen) {
    const auto before = simd_targets();
    override_simd_target("scalar");
    EXPECT_EQ(simd_targets(), before);
    override_simd_target("auto");
    EXPECT_EQ(simd_targets(), before);
}

TEST(OverrideSimdTarget, RefusesWhatTheMachineDoesNotHave) {
    EXPECT_THROW(override_simd_target("avx1024"), Error);
    EXPECT_THROW(override_simd_target(""), Error);
}

}  // namespace
}  // namespace earshot
