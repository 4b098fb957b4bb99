// SPDX-License-Identifier: MIT
#include "earshot/audio/temporal_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace earshot::audio {
namespace {

/// Of one band and bins of the given energies.
EnergyHistogram histogram(const std::vector<double>& energies) {
    EnergyHistogram result{.energy = std::vector<Spectrum>(energies.size())};
    for (std::size_t n = 0; n < energies.size(); ++n) {
        result.energy[n][0] = energies[n];
    }
    return result;
}

TEST(TemporalDifference, IsNothingWhereEstimatesFollowTheExactEnergies) {
    const std::vector<EnergyHistogram> exact = {histogram({1, 2, 3}), histogram({5, 1, 0.1})};
    const auto result = temporal_difference(exact, exact, 1, 1);
    EXPECT_EQ(result.difference, 0.0);
    EXPECT_EQ(result.error, 0.0);
}

// A constant share of the exact energies is an error, not a flicker.
TEST(TemporalDifference, DoesNotCountWhatStaysAway) {
    const std::vector<EnergyHistogram> exact = {histogram({1, 2, 4}), histogram({8, 1, 0.5})};
    const std::vector<EnergyHistogram> half = {histogram({0.5, 1, 2}), histogram({4, 0.5, 0.25})};
    const auto result = temporal_difference(half, exact, 1, 1);
    EXPECT_EQ(result.difference, 0.0);
    EXPECT_EQ(result.error, 0.5);
}

TEST(TemporalDifference, IsTheRootOfTheMeanSquareOverIntervalsAndUpdates) {
    // Intervals of two bins; the third bin is an interval of its own, without energy at first.
    const std::vector<EnergyHistogram> exact = {
        histogram({1, 1, 0}), histogram({2, 2, 1}), histogram({1, 3, 2})};
    const std::vector<EnergyHistogram> estimates = {
        histogram({3, 0, 7}), histogram({1, 1, 2}), histogram({5, 0, 1})};
    // Ratios: 1.5, -; 0.5, 2; 1.25, 0.5.
    const auto result = temporal_difference(estimates, exact, 1, 2);
    EXPECT_DOUBLE_EQ(result.difference, std::sqrt((1.0 + 0.75 * 0.75 + 1.5 * 1.5) / 3.0));
    EXPECT_DOUBLE_EQ(result.error, std::sqrt((0.25 + 0.25 + 1.0 + 0.25 * 0.25 + 0.25) / 5.0));
}

}  // namespace
}  // namespace earshot::audio
