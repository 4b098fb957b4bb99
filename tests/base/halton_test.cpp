// SPDX-License-Identifier: MIT
#include "earshot/base/halton.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace earshot {
namespace {

TEST(RadicalInverse, BeginsAsPublished) {
    struct Row {
        std::uint32_t base;
        std::array<double, 4> first;
    };
    for (const Row& row : {Row{2, {0.5, 0.25, 0.75, 0.125}},
                           Row{3, {1.0 / 3, 2.0 / 3, 1.0 / 9, 4.0 / 9}},
                           Row{5, {0.2, 0.4, 0.6, 0.8}},
                           Row{7, {1.0 / 7, 2.0 / 7, 3.0 / 7, 4.0 / 7}}}) {
        EXPECT_EQ(radical_inverse(0, row.base), 0.0);
        for (std::uint64_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(radical_inverse(i + 1, row.base), row.first[i], 1e-15) << row.base;
        }
    }
}

TEST(RadicalInverse, FillsEveryPartOnceInTurn) {
    std::vector<int> filled(81, 0);
    for (std::uint64_t i = 0; i < 81; ++i) {
        // The middle of the part keeps away from its borders.
        ++filled[static_cast<std::size_t>(81.0 * (radical_inverse(i, 3) + 0.5 / 81.0))];
    }
    EXPECT_EQ(filled, std::vector<int>(81, 1));
}

TEST(RadicalInverse, StaysBelowOne) {
    for (const std::uint32_t base : {2U, 3U, 5U, 7U, 11U}) {
        EXPECT_LT(radical_inverse(~std::uint64_t{0}, base), 1.0);
        EXPECT_LT(shifted_radical_inverse(~std::uint64_t{0}, base, 0.999), 1.0);
    }
    EXPECT_DOUBLE_EQ(shifted_radical_inverse(1, 2, 0.75), 0.25);
}

}  // namespace
}  // namespace earshot
