// SPDX-License-Identifier: MIT
#include "earshot/base/spelling.h"

#include <gtest/gtest.h>

#include <array>

namespace earshot {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
    EXPECT_EQ(edit_distance("", ""), 0U);
    EXPECT_EQ(edit_distance("wall", "wall"), 0U);
    EXPECT_EQ(edit_distance("", "wall"), 4U);
    EXPECT_EQ(edit_distance("wall", ""), 4U);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);   // Levenshtein's textbook pair
    EXPECT_EQ(edit_distance("saturday", "sunday"), 3U);  // likewise
    EXPECT_EQ(edit_distance("materails", "materials"), 1U);
    EXPECT_EQ(edit_distance("ca", "abc"), 3U);  // no letter is edited twice (else it would be 2)
}

TEST(ClosestWord, IsTheWordThatWasMeant) {
    const std::array<std::string, 4> words = {"ir", "los", "materials", "metrics"};
    EXPECT_EQ(closest_word("materails", words), "materials");  // neighbours swapped
    EXPECT_EQ(closest_word("metric", words), "metrics");       // one missing
    EXPECT_EQ(closest_word("irr", words), "ir");               // one too many
    EXPECT_EQ(closest_word("lod", words), "los");              // one wrong
}

TEST(ClosestWord, IsNoneThatIsFarAway) {
    const std::array<std::string, 2> words = {"ir", "materials"};
    EXPECT_EQ(closest_word("xyzzy", words), "");
    EXPECT_EQ(closest_word("", words), "");
    EXPECT_EQ(closest_word("anything", {}), "");
}

TEST(ClosestWord, IsTheFirstOfEquals) {
    const std::array<std::string, 2> words = {"--to", "--of"};
    EXPECT_EQ(closest_word("--tf", words), "--to");
}

TEST(ClosestWords, AreRankedByDistanceThenAlphabetically) {
    const std::array<std::string, 4> words = {"glass", "class", "brick", "grass"};
    EXPECT_EQ(closest_words("glas", words, 3),
              (std::vector<std::string>{"glass", "class", "grass"}));
    EXPECT_EQ(closest_words("glas", words, 9).size(), 4U);
    EXPECT_TRUE(closest_words("glas", {}, 3).empty());
}

TEST(DidYouMean, FallsBackWhereNoWordIsClose) {
    const std::array<std::string, 2> words = {"brick", "glass"};
    EXPECT_EQ(did_you_mean("brik", words, "see the list"), "did you mean brick?");
    EXPECT_EQ(did_you_mean("xyzzy", words, "see the list"), "see the list");
}

}  // namespace
}  // namespace earshot
