// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/edge_level.h"

#include "earshot/base/math.h"
#include "earshot/propagation/diffraction.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;
using support::Dice;

frustum::EdgeEnd random_end(const geometry::Wedge& wedge, Dice& dice) {
    frustum::EdgeEnd end;
    end.image = {std::exp(dice.between(-3.0, 2.5)),
                 dice.between(0.0, 1.0) * wedge.open_angle,
                 dice.between(-6.0, 6.0)};
    return end;
}

/// An end close to where a path over the edge is straight, or reflected in a face.
frustum::EdgeEnd end_at_boundary(const geometry::Wedge& wedge,
                                 const frustum::EdgeEnd& source,
                                 Dice& dice) {
    frustum::EdgeEnd end = random_end(wedge, dice);
    const std::array<double, 4> angles{source.image.angle + math::kPi,
                                       source.image.angle - math::kPi,
                                       math::kPi - source.image.angle,
                                       2.0 * wedge.open_angle - math::kPi - source.image.angle};
    const double angle = angles[dice.below(4)] +
                         std::exp(dice.between(-25.0, 0.0)) * (dice.chance(0.5) ? 1.0 : -1.0);
    end.image.angle = std::clamp(angle, 0.0, wedge.open_angle);
    return end;
}

TEST(EdgeLevel, BoundsAreNeverBelowThePressure) {
    Dice dice(1);
    std::vector<double> excess_db;
    for (int i = 0; i < 4000; ++i) {
        const double angle =
            dice.chance(0.3) ? 2.0 * math::kPi : dice.between(1.05, 1.99) * math::kPi;
        const geometry::Wedge wedge = geometry::make_wedge(
            Vec3(0.0), Vec3(0, 0, std::exp(dice.between(-3.0, 2.0))), Vec3(1, 0, 0), angle);
        const frustum::EdgeEnd source = random_end(wedge, dice);
        const frustum::EdgeEnd listener =
            dice.chance(0.5) ? random_end(wedge, dice) : end_at_boundary(wedge, source, dice);
        const std::array<double, 3> factors{
            1.0, dice.chance(0.2) ? 0.0 : dice.between(0.0, 1.0), dice.between(0.0, 1.0)};
        EdgeDiffraction edge{.open_angle = angle,
                             .source = source.image,
                             .listener = listener.image,
                             .pressure_factors = factors};
        for (auto& side : edge.sides) {
            side = dice.chance(0.5) ? ZoneSide::lit : ZoneSide::shadow;
        }
        for (int part = 0; part < 3; ++part) {
            edge.z_begin = part == 0 ? 0.0 : dice.between(0.0, wedge.length());
            edge.z_end = part == 0 ? wedge.length() : dice.between(edge.z_begin, wedge.length());
            const double of_part = max_diffracted_pressure(edge);
            const double bound =
                max_pressure_between(wedge, {edge.z_begin, edge.z_end}, source, listener, factors);
            double loudest = 0.0;
            for (const double frequency : {20.0, 31.5, 125.0, 500.0, 2000.0, 16000.0}) {
                const double k = 2.0 * math::kPi * frequency / 343.0;
                loudest = std::max(loudest, std::abs(diffracted_pressure(edge, k).total()));
            }
            ASSERT_LE(loudest, of_part) << "case " << i;
            ASSERT_LE(loudest, bound) << "case " << i;
            if (part == 0) {
                excess_db.push_back(20.0 * std::log10(bound / std::max(loudest, 1e-12)));
            }
        }
    }
    std::sort(excess_db.begin(), excess_db.end());
    EXPECT_LT(excess_db[excess_db.size() / 2], 30.0);
}

}  // namespace
}  // namespace earshot::propagation
