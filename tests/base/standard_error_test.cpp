// SPDX-License-Identifier: MIT
#include "earshot/base/standard_error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace earshot {
namespace {

TEST(StandardErrorOfMean, IsTheSampleDeviationOverTheRootOfTheCount) {
    // Mean 5, squared deviations 9 + 1 + 1 + 1 + 4: a variance of 4, of five values.
    const std::array<double, 5> values = {2.0, 4.0, 6.0, 6.0, 7.0};
    EXPECT_NEAR(standard_error_of_mean(values), std::sqrt(4.0 / 5.0), 1e-15);
}

TEST(StandardErrorOfMean, IsZeroForEqualValues) {
    const std::array<double, 3> values = {0.25, 0.25, 0.25};
    EXPECT_NEAR(standard_error_of_mean(values), 0.0, 1e-16);
}

}  // namespace
}  // namespace earshot
