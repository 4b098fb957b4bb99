// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/triangle_lanes.h"

#include "earshot/base/simd.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "hard_triangles.h"
#include "support/meshes.h"
#include <string>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Vec3;

constexpr std::size_t kWidth = TriangleLanes::kWidth;

bool is_in(std::uint32_t bits, std::size_t lane) {
    return (bits >> lane & 1U) != 0;
}

TEST(TriangleLanes, AreNeverWrongAboutHardPairs) {
    std::vector<LanesDecided> of_best;
    for (const std::string& target : simd_targets()) {
        SCOPED_TRACE(target);
        override_simd_target(target);
        int decided = 0;
        std::vector<LanesDecided> all;
        for (std::uint64_t i = 0; i < 4000; i += kWidth) {
            TriangleLanes lanes;
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                const auto [a, b] = test::hard_pair(1, i + lane).scaled(-20);
                lanes.set(lane, a, b);
            }
            all.push_back(decide_lanes(lanes, {}, {}));
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                const test::WholePair pair = test::hard_pair(1, i + lane);
                const bool expected = test::meet_exactly(pair.one, pair.other);
                ASSERT_FALSE(is_in(all.back().disjoint, lane) && expected) << i + lane;
                ASSERT_FALSE(is_in(all.back().intersecting, lane) && !expected) << i + lane;
                decided += is_in(all.back().disjoint | all.back().intersecting, lane) ? 1 : 0;
            }
        }
        EXPECT_GT(decided, 1000);
        of_best = of_best.empty() ? all : of_best;
        EXPECT_EQ(all, of_best);
    }
    override_simd_target("auto");
}

TEST(TriangleLanes, DecideAllButFewRandomPairsWhereTheyStand) {
    const auto point = [](std::uint64_t i) { return test::random_point(3, i); };
    std::uint64_t next = 0;
    int undecided = 0;
    int intersecting = 0;
    for (int round = 0; round < 250; ++round) {
        const Vec3 x = glm::normalize(point(next++));
        const Vec3 y = glm::normalize(glm::cross(x, point(next++)));
        const Pose one{{x, y, glm::cross(x, y)}, point(next++)};
        const Pose other{{y, glm::cross(y, x), -x}, one.translation + 0.3 * point(next++)};
        std::vector<bool> expected;
        TriangleLanes lanes;
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            Corners a, b, placed_a, placed_b;
            for (std::size_t k = 0; k < 3; ++k) {
                a[k] = point(next++);
                b[k] = point(next++);
                placed_a[k] = one.apply(a[k]);
                placed_b[k] = other.apply(b[k]);
            }
            lanes.set(lane, a, b);
            expected.push_back(intersect(placed_a, placed_b));
        }
        const LanesDecided decided = decide_lanes(lanes, one, other);
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            const bool is_known = is_in(decided.disjoint | decided.intersecting, lane);
            undecided += is_known ? 0 : 1;
            EXPECT_TRUE(!is_known || is_in(decided.intersecting, lane) == expected[lane]) << round;
            EXPECT_FALSE(is_in(decided.disjoint & decided.intersecting, lane)) << round;
            intersecting += expected[lane] ? 1 : 0;
        }
    }
    EXPECT_LT(undecided, 3);
    EXPECT_GT(intersecting, 200);
    EXPECT_LT(intersecting, 1800);
}

}  // namespace
}  // namespace earshot::collision
