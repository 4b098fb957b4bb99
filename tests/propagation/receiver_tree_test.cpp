// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/receiver_tree.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// The length of a ray's part in a ball, up to a distance.
double chord_length(const geometry::Ray& ray, double end, const ReceiverTree::Ball& ball) {
    const Vec3 to = ball.centre - ray.origin;
    const double along = glm::dot(to, ray.direction);
    const double half_squared = ball.radius * ball.radius -
                                glm::dot(to - along * ray.direction, to - along * ray.direction);
    if (!(half_squared > 0.0)) {
        return 0.0;
    }
    const double half = std::sqrt(half_squared);
    return std::max(0.0, std::min(end, along + half) - std::max(0.0, along - half));
}

TEST(ReceiverTree, FindsEveryBallThatARayCrosses) {
    support::Dice dice(7);
    for (const std::size_t count : {0, 1, 3, 5, 64, 700}) {
        std::vector<ReceiverTree::Ball> balls;
        for (std::size_t k = 0; k < count; ++k) {
            balls.push_back({{dice.between(0, 20), dice.between(0, 2), dice.between(0, 30)},
                             dice.between(0.1, 1.5)});
        }
        const ReceiverTree tree(balls);
        std::size_t visited = 0, crossed = 0;
        for (int n = 0; n < 300; ++n) {
            const Vec3 direction(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
            const geometry::Ray ray = {
                .origin = {dice.between(0, 20), dice.between(-1, 4), dice.between(0, 30)},
                .direction = glm::normalize(direction)};
            const double end =
                n % 5 == 0 ? std::numeric_limits<double>::infinity() : dice.between(0, 15);
            std::multiset<std::size_t> found;
            tree.visit(ray, end, [&](std::size_t k) { found.insert(k); });
            visited += found.size();
            for (std::size_t k = 0; k < count; ++k) {
                EXPECT_LE(found.count(k), 1U);
                if (chord_length(ray, end, balls[k]) > 0.0) {
                    ++crossed;
                    EXPECT_EQ(found.count(k), 1U) << "ball " << k << " of " << count;
                }
            }
        }
        // Of many it looks at few others.
        if (count == 700) {
            EXPECT_LT(visited, 300 * count / 10);
        }
    }
}

}  // namespace
}  // namespace earshot::propagation
