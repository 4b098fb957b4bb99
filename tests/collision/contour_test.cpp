// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/contour.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <cmath>
#include <numeric>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using geometry::VertexId;
using support::Dice;

/// A loop in the plane z = 0, with heights that do not matter.
struct TestContour {
    MovingScene scene;
    std::vector<VertexId> vertices;
};

TestContour contour_of(std::vector<Vec3> begin, std::vector<Vec3> end) {
    TestContour loop;
    loop.vertices.resize(begin.size());
    std::iota(loop.vertices.begin(), loop.vertices.end(), 0U);
    loop.scene.begin = std::move(begin);
    loop.scene.end = std::move(end);
    return loop;
}

bool self_intersects(const TestContour& loop) {
    return contour_self_intersects(loop.scene, loop.vertices, Vec3(0.0, 0.0, 1.0));
}

double side(const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether two edges without a common corner cross at one of many times.
bool crosses_at_some_time(const TestContour& loop) {
    const std::size_t n = loop.vertices.size();
    for (int step = 0; step <= 200; ++step) {
        const double t = step / 200.0;
        const auto at = [&](std::size_t i) {
            return loop.scene.begin[i % n] + t * (loop.scene.end[i % n] - loop.scene.begin[i % n]);
        };
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t k = i + 2; k < n; ++k) {
                if ((k + 1) % n != i &&
                    side(at(i), at(i + 1), at(k)) * side(at(i), at(i + 1), at(k + 1)) < 0.0 &&
                    side(at(k), at(k + 1), at(i)) * side(at(k), at(k + 1), at(i + 1)) < 0.0) {
                    return true;
                }
            }
        }
    }
    return false;
}

std::vector<Vec3> ring(std::size_t n, double shake, Dice& dice) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < n; ++i) {
        const double turn =
            2.0 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(n);
        points.emplace_back(std::cos(turn) + dice.between(-shake, shake),
                            std::sin(turn) + dice.between(-shake, shake),
                            dice.between(-1.0, 1.0));
    }
    return points;
}

TEST(MovingLoop, NeverOverlooksACrossing) {
    Dice dice(1);
    int crossings = 0, proven = 0;
    for (int i = 0; i < 2000; ++i) {
        const double shake = dice.between(0.0, 0.8);
        const auto n = static_cast<std::size_t>(dice.between(3.0, 12.0));
        const TestContour loop = contour_of(ring(n, shake, dice), ring(n, shake, dice));
        const bool crosses = crosses_at_some_time(loop);
        const bool may_self_intersect = self_intersects(loop);
        EXPECT_TRUE(may_self_intersect || !crosses) << i;
        crossings += crosses ? 1 : 0;
        proven += may_self_intersect ? 0 : 1;
    }
    EXPECT_GT(crossings, 150);
    EXPECT_GT(proven, 300);
}

TEST(MovingLoop, PassesWhatIsSimple) {
    Dice dice(2);
    for (const std::size_t n : {3U, 4U, 7U, 50U, 200U}) {
        const auto points = ring(n, 0.0, dice);
        auto turned = points;
        for (Vec3& p : turned) {
            p = Vec3(0.9 * p.x - 0.3 * p.y + 5.0, 0.3 * p.x + 0.9 * p.y, p.z + 7.0);
        }
        EXPECT_FALSE(self_intersects(contour_of(points, turned))) << n;
    }
}

TEST(MovingLoop, SeesEdgesThatFoldOntoTheirNeighbour) {
    const std::vector<Vec3> open{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<Vec3> folded{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0, 1, 0}};
    EXPECT_FALSE(self_intersects(contour_of(open, open)));
    EXPECT_TRUE(self_intersects(contour_of(open, folded)));
    EXPECT_TRUE(self_intersects(contour_of(folded, open)));
}

TEST(MovingLoop, SeesWhatMeetsHalfWayOnly) {
    // A corner passes an edge and is beyond it at the end.
    const std::vector<Vec3> begin{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}};
    auto end = begin;
    end[3].y = -1.0;
    EXPECT_TRUE(self_intersects(contour_of(begin, end)));
    EXPECT_FALSE(self_intersects(contour_of(begin, begin)));
}

}  // namespace
}  // namespace earshot::collision
