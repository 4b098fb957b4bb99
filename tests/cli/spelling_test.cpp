// SPDX-License-Identifier: MIT
#include "earshot/cli/spelling.h"

#include <gtest/gtest.h>

#include <array>

namespace earshot::cli {
namespace {

TEST(Spelling, FindsTheWordThatWasMeant) {
    const std::array<std::string, 4> words = {"ir", "los", "materials", "metrics"};
    EXPECT_EQ(nearest_word("materails", words), "materials");  // neighbours swapped
    EXPECT_EQ(nearest_word("metric", words), "metrics");       // one missing
    EXPECT_EQ(nearest_word("irr", words), "ir");               // one too many
    EXPECT_EQ(nearest_word("lod", words), "los");              // one wrong
}

TEST(Spelling, OffersNothingThatIsFarAway) {
    const std::array<std::string, 2> words = {"ir", "materials"};
    EXPECT_EQ(nearest_word("xyzzy", words), "");
    EXPECT_EQ(nearest_word("", words), "");
    EXPECT_EQ(nearest_word("anything", {}), "");
}

TEST(Spelling, OfEqualsTakesTheFirst) {
    const std::array<std::string, 2> words = {"--to", "--of"};
    EXPECT_EQ(nearest_word("--tf", words), "--to");
}

}  // namespace
}  // namespace earshot::cli
