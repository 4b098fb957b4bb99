// SPDX-License-Identifier: MIT
#include "earshot/geometry/intersect.h"

#include "earshot/base/random.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace earshot::geometry {
namespace {

using Lattice = glm::i64vec3;

Lattice cross(const Lattice& a, const Lattice& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

std::int64_t dot(const Lattice& a, const Lattice& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// The oracle: closed convex sets are disjoint if and only if an axis separates them, and for a
// segment and a triangle one of these does (separating axis theorem), in whole numbers.
bool oracle_touches(const std::array<Lattice, 2>& segment, const std::array<Lattice, 3>& triangle) {
    const Lattice along = segment[1] - segment[0];
    const Lattice normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    std::vector<Lattice> axes = {normal, cross(normal, along)};
    for (std::size_t i = 0; i < 3; ++i) {
        const Lattice edge = triangle[(i + 1) % 3] - triangle[i];
        axes.push_back(cross(along, edge));
        axes.push_back(cross(normal, edge));
    }
    return std::none_of(axes.begin(), axes.end(), [&](const Lattice& axis) {
        const auto [s0, s1] = std::minmax({dot(axis, segment[0]), dot(axis, segment[1])});
        const auto [t0, t1] =
            std::minmax({dot(axis, triangle[0]), dot(axis, triangle[1]), dot(axis, triangle[2])});
        return s1 < t0 || t1 < s0;
    });
}

// Where a touching segment does so first: where it crosses the plane or, within the plane, where
// the last of the three edges lets it in. In whole numbers but for the division.
double oracle_first_touch(const std::array<Lattice, 2>& segment,
                          const std::array<Lattice, 3>& triangle) {
    const auto share = [](std::int64_t from, std::int64_t to) {
        return static_cast<double>(static_cast<long double>(from) /
                                   static_cast<long double>(from - to));
    };
    const Lattice normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    const std::int64_t from = dot(normal, segment[0] - triangle[0]);
    const std::int64_t to = dot(normal, segment[1] - triangle[0]);
    if (from != to) {
        return share(from, to);
    }
    double entry = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Lattice inward = cross(normal, triangle[(i + 1) % 3] - triangle[i]);
        const std::int64_t first = dot(inward, segment[0] - triangle[i]);
        const std::int64_t last = dot(inward, segment[1] - triangle[i]);
        entry = first < 0 ? std::max(entry, share(first, last)) : entry;
    }
    return entry;
}

Lattice lattice_point(std::uint64_t seed, std::uint64_t index, std::int64_t size) {
    const auto coordinate = [&](std::uint64_t axis) {
        return static_cast<std::int64_t>(random_bits(seed, axis, index) %
                                         static_cast<std::uint64_t>(2 * size + 1)) -
               size;
    };
    return {coordinate(0), coordinate(1), coordinate(2)};
}

TEST(Touches, EqualsAnExactOracleOnSmallWholeNumbers) {
    int touching = 0;
    int tested = 0;
    for (std::uint64_t seed = 0; seed < 60000; ++seed) {
        const auto size = static_cast<std::int64_t>(1 + seed % 4);
        const std::array<Lattice, 3> t = {lattice_point(seed, 0, size),
                                          lattice_point(seed, 1, size),
                                          lattice_point(seed, 2, size)};
        const std::array<Lattice, 2> s = {lattice_point(seed, 3, size),
                                          lattice_point(seed, 4, size)};
        if (cross(t[1] - t[0], t[2] - t[0]) == Lattice(0)) {
            continue;
        }
        // A scale that is no power of two would round; an offset shifts the exponents.
        const double unit = seed % 2 == 0 ? 1.0 : 0x1p-30;
        const auto real = [&](const Lattice& p) {
            return unit * Vec3(p) + Vec3(static_cast<double>(seed % 3));
        };
        const Segment segment{real(s[0]), real(s[1])};
        const bool expected = oracle_touches(s, t);
        ASSERT_EQ(touches(segment, real(t[0]), real(t[1]), real(t[2])), expected)
            << "seed " << seed;
        const auto touch = first_touch(segment, real(t[0]), real(t[1]), real(t[2]));
        ASSERT_EQ(touch.has_value(), expected) << "seed " << seed;
        if (expected) {
            ASSERT_DOUBLE_EQ(*touch, oracle_first_touch(s, t)) << "seed " << seed;
        }
        touching += expected ? 1 : 0;
        ++tested;
    }
    EXPECT_GT(touching, tested / 10);
    EXPECT_LT(touching, tested * 9 / 10);
}

// Two corners equal, all equal, or three on a line of whole numbers: no segment touches them, not
// even one through a corner, along the line or to a point on it.
TEST(Touches, IsFalseForTrianglesWithoutArea) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const auto whole = [&](std::uint64_t stream) {
            return std::floor(random_between(5, stream, i, -4.0, 5.0));
        };
        const Vec3 a(whole(0), whole(1), whole(2));
        const Vec3 step(whole(3), whole(4), whole(5));
        const Vec3 b = a + whole(6) * step;
        const Vec3 c = a + whole(7) * step;
        const Vec3 elsewhere(whole(8), whole(9), whole(10));
        for (const Segment& segment : {Segment{a, elsewhere},
                                       Segment{elsewhere, b},
                                       Segment{a - step, a + step},
                                       Segment{2.0 * b - elsewhere, elsewhere},
                                       Segment{c, c}}) {
            ASSERT_FALSE(touches(segment, a, b, c)) << i;
            ASSERT_FALSE(first_touch(segment, a, b, c)) << i;
        }
    }
    // A corner that is off the line by the last bit makes an area.
    const Vec3 a(0.0, 0.0, 0.0), b(1.0, 2.0, 3.0), c(2.0, 4.0, std::nextafter(6.0, 7.0));
    EXPECT_TRUE(touches({a, b}, a, b, c));
}

TEST(FirstTouch, IsWhereTheSegmentMeetsTheTriangle) {
    const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
    EXPECT_DOUBLE_EQ(*first_touch({{1, 1, 3}, {1, 1, -1}}, a, b, c), 0.75);
    EXPECT_DOUBLE_EQ(*first_touch({{1, 1, 0}, {1, 1, -1}}, a, b, c), 0.0);
    EXPECT_DOUBLE_EQ(*first_touch({{-1, 1, 0}, {4, 1, 0}}, a, b, c), 0.2);  // in the plane
    EXPECT_DOUBLE_EQ(*first_touch({{1, 1, 0}, {9, 9, 0}}, a, b, c), 0.0);
    EXPECT_FALSE(first_touch({{1, 1, 3}, {1, 1, 1}}, a, b, c));
}

TEST(FirstTouch, IsPreciseAtGrazingAngles) {
    // Ends within a unit or so of the plane of a triangle 2^18 units across: determinants take up
    // to 60 bits, and in plain doubles the parameter would be off by 2^-29.
    constexpr std::int64_t kSize = std::int64_t{1} << 18;
    int touching = 0;
    for (std::uint64_t seed = 0; seed < 60000; ++seed) {
        const std::array<Lattice, 3> t = {lattice_point(seed, 0, kSize),
                                          lattice_point(seed, 1, kSize),
                                          lattice_point(seed, 2, kSize)};
        const auto near_plane = [&](std::uint64_t i) {
            const Vec3 ab(t[1] - t[0]), ac(t[2] - t[0]);
            const Vec3 in_plane = random_between(seed, 3, i, -0.3, 0.8) * ab +
                                  random_between(seed, 4, i, -0.3, 0.8) * ac;
            return t[0] + Lattice(glm::round(in_plane));
        };
        const std::array<Lattice, 2> s = {near_plane(0), near_plane(1)};
        const Lattice normal = cross(t[1] - t[0], t[2] - t[0]);
        if (normal == Lattice(0) || dot(normal, s[0] - t[0]) == dot(normal, s[1] - t[0])) {
            continue;
        }
        const auto touch =
            first_touch({Vec3(s[0]), Vec3(s[1])}, Vec3(t[0]), Vec3(t[1]), Vec3(t[2]));
        if (touch) {
            ASSERT_NEAR(*touch, oracle_first_touch(s, t), 0x1p-37) << "seed " << seed;
            ++touching;
        }
    }
    EXPECT_GT(touching, 5000);
}

double nasty_number(std::uint64_t seed, std::uint64_t index) {
    constexpr std::array<double, 8> kSpecial = {0.0, -0.0, 1.0, -1.0, 1e-30, 1e30, 5e-324, 0.1};
    const std::uint64_t bits = random_bits(seed, 9, index);
    return bits % 3 == 0 ? kSpecial[(bits / 3) % kSpecial.size()]
                         : random_between(seed, 10, index, -2.0, 2.0);
}

TEST(SlabTest, TheIntervalOfABoxInsideAnotherLiesInsideTheOthers) {
    int passed = 0;
    for (std::uint64_t seed = 0; seed < 100000; ++seed) {
        const Vec3 origin(nasty_number(seed, 0), nasty_number(seed, 1), nasty_number(seed, 2));
        const Vec3 direction(nasty_number(seed, 3), nasty_number(seed, 4), nasty_number(seed, 5));
        Aabb inner, outer;
        for (std::uint64_t i = 0; i < 4; ++i) {
            const Vec3 point(nasty_number(seed, 10 + 3 * i),
                             nasty_number(seed, 11 + 3 * i),
                             nasty_number(seed, 12 + 3 * i));
            outer.include(point);
            if (i < 2) {
                inner.include(point);
            }
        }
        const SlabTest slab_test(origin, direction, 1e30);
        const SlabTest exact(origin, direction, 0.0);
        for (const SlabTest& each : {slab_test, exact}) {
            const auto in_inner = each.interval(inner, 1e300);
            const auto in_outer = each.interval(outer, 1e300);
            // Also where the inner box is missed: near and far are monotone on their own.
            ASSERT_LE(in_outer.min, in_inner.min) << "seed " << seed;
            ASSERT_GE(in_outer.max, in_inner.max) << "seed " << seed;
            ASSERT_LE(each.interval(outer).min, each.interval(inner).min) << "seed " << seed;
            ASSERT_GE(each.interval(outer).max, each.interval(inner).max) << "seed " << seed;
            passed += in_inner.is_empty() ? 0 : 1;
        }
    }
    EXPECT_GT(passed, 5000);
}

TEST(SlabTest, KeepsEveryPointOfABox) {
    // Corners and points of faces and edges, aimed at from near and far, along and across axes.
    for (std::uint64_t seed = 0; seed < 100000; ++seed) {
        const double size = seed % 3 == 0 ? 1e-3 : seed % 3 == 1 ? 1.0 : 1e6;
        const auto number = [&](std::uint64_t i) {
            return size * random_between(seed, 11, i, -1.0, 1.0);
        };
        const Vec3 p(number(0), number(1), number(2)), q(number(3), number(4), number(5));
        Aabb box;
        box.include(p);
        box.include(q);
        Vec3 inside = p;
        Vec3 origin(number(6), number(7), number(8));
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            const std::uint64_t choice = random_bits(seed, 12, k);
            inside[axis] = choice % 3 == 0   ? static_cast<double>(box.lower[k])
                           : choice % 3 == 1 ? static_cast<double>(box.upper[k])
                                             : p[axis];
            origin[axis] = choice % 5 == 0 ? inside[axis] : origin[axis];
        }
        const double t = random(seed, 13, 0);
        const SlabTest slab_test(origin, (inside - origin) / t, size);
        const Interval interval = slab_test.interval(box, 2.0);
        ASSERT_FALSE(interval.is_empty()) << "seed " << seed;
        ASSERT_LE(interval.min, t) << "seed " << seed;
        ASSERT_GE(interval.max, t) << "seed " << seed;
    }
}

TEST(PreparedRay, AHitLiesInThePassageOfEveryBoxAroundTheTriangle) {
    // Rays all but in the plane of the triangle, whose weights are mere rounding, and slivers.
    int hits = 0;
    for (std::uint64_t seed = 0; seed < 200000; ++seed) {
        const auto point = [&](std::uint64_t i) {
            return Vec3(random_between(seed, 0, i, -1.0, 1.0),
                        random_between(seed, 1, i, -1.0, 1.0),
                        random_between(seed, 2, i, -1.0, 1.0));
        };
        const Vec3 a = point(0);
        const Vec3 b = point(1);
        const Vec3 c = seed % 5 == 0 ? b + 1e-13 * point(2) : point(2);
        Ray ray{.direction = random_between(seed, 3, 0, -1.0, 1.0) * (b - a) +
                             random_between(seed, 3, 1, -1.0, 1.0) * (c - a)};
        ray.origin = a + random(seed, 3, 2) * (b - a) - 2.0 * random(seed, 3, 3) * ray.direction;
        const PreparedRay prepared(ray, 1.0);
        const auto hit = prepared.hit(a, b, c, prepared.t_max());
        if (!hit) {
            continue;
        }
        Aabb box = triangle_box(a, b, c);
        if (seed % 2 == 0) {
            box.include(point(6));
        }
        const Interval interval = prepared.box_interval(box, prepared.t_max());
        ASSERT_FALSE(interval.is_empty()) << "seed " << seed;
        ASSERT_GE(hit->t, interval.min) << "seed " << seed;
        ASSERT_LE(hit->t, interval.max) << "seed " << seed;
        ++hits;
    }
    EXPECT_GT(hits, 10000);
}

TEST(PreparedRay, ATriangleOfAFewUlpsAsideOfTheRayIsNotHit) {
    // Its edge functions are mere rounding and often agree in sign.
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        const auto corner = [&](std::uint64_t i) {
            const auto ulps = [&](std::uint64_t k) {
                return 0x1p-53 * static_cast<double>(random_bits(seed, i, k) % 5);
            };
            return Vec3(0.7 + ulps(0), 0.6 + ulps(1), 1.0 + ulps(2));
        };
        const PreparedRay ray({.direction = {0.1, 0.2, 1.0}}, 1.0);
        ASSERT_FALSE(ray.hit(corner(0), corner(1), corner(2), 10.0)) << "seed " << seed;
    }
}

// Moeller and Trumbore 1997 in extended precision: where the line meets the plane of the triangle,
// and with which weights.
std::array<long double, 3> oracle_hit(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
    using Long = glm::vec<3, long double>;
    const Long direction(ray.direction), ab = Long(b) - Long(a), ac = Long(c) - Long(a);
    const Long across = glm::cross(direction, ac);
    const Long from_a = Long(ray.origin) - Long(a);
    const Long upward = glm::cross(from_a, ab);
    const long double determinant = glm::dot(ab, across);
    return {glm::dot(ac, upward) / determinant,
            glm::dot(from_a, across) / determinant,
            glm::dot(direction, upward) / determinant};
}

TEST(PreparedRay, HitsExactlyWhatTheRayReaches) {
    // Origins lie inside the triangle's own box as often as not, on either side of its plane.
    constexpr long double kClear = 1e-9L;
    int hits = 0, behind = 0, too_far = 0;
    for (std::uint64_t seed = 0; seed < 60000; ++seed) {
        const auto point = [&](std::uint64_t i) {
            return Vec3(random_between(seed, 0, i, -1.0, 1.0),
                        random_between(seed, 1, i, -1.0, 1.0),
                        random_between(seed, 2, i, -1.0, 1.0));
        };
        const Vec3 a = point(0), b = point(1), c = point(2);
        const Vec3 target = a + random(seed, 3, 0) * (b - a) + random(seed, 3, 1) * (c - a);
        Ray ray{.origin = 0.5 * point(3)};
        ray.direction = (seed % 2 == 0 ? 1.0 : -1.0) * (target - ray.origin);
        ray.t_max = 2.0 * random(seed, 3, 2);
        const auto [t, u, v] = oracle_hit(ray, a, b, c);
        const long double inside = std::min({u, v, 1.0L - u - v});
        const long double reached = std::min(t, static_cast<long double>(ray.t_max) - t);
        if (!(std::abs(inside) > kClear && std::abs(reached) > kClear)) {
            continue;
        }
        const PreparedRay prepared(ray, 1.0);
        const auto hit = prepared.hit(a, b, c, prepared.t_max());
        ASSERT_EQ(hit.has_value(), inside > 0.0L && reached > 0.0L) << "seed " << seed;
        if (hit) {
            ASSERT_NEAR(hit->t, static_cast<double>(t), 1e-9) << "seed " << seed;
            ASSERT_NEAR(hit->u, static_cast<double>(u), 1e-9) << "seed " << seed;
            ASSERT_NEAR(hit->v, static_cast<double>(v), 1e-9) << "seed " << seed;
        }
        hits += hit ? 1 : 0;
        behind += inside > 0.0L && t < 0.0L ? 1 : 0;
        too_far += inside > 0.0L && t > ray.t_max ? 1 : 0;
    }
    EXPECT_GT(hits, 3000);
    EXPECT_GT(behind, 3000);
    EXPECT_GT(too_far, 3000);
}

TEST(PreparedRay, BothTrianglesOfASharedEdgeAreHitOnIt) {
    const Vec3 a(0, 0, 1), b(0, 2, 1), left(-1, 1, 1), right(1, 1, 1);
    const PreparedRay ray({.origin = {0, 0.7, 0}, .direction = {0, 0, 1}}, 2.0);
    EXPECT_TRUE(ray.hit(a, b, left, 10.0));
    EXPECT_TRUE(ray.hit(b, a, right, 10.0));
    EXPECT_TRUE(ray.hit(a, right, b, 10.0));  // either side
    EXPECT_FALSE(ray.hit(a, b, right, 0.5));  // too far
}

TEST(TriangleBox, HoldsTheCornersAndIsTight) {
    const Aabb box = triangle_box({0.1, -2, 3}, {1, 0.2, 3}, {0.5, 0.3, 3.5});
    EXPECT_EQ(box.lower, (std::array<float, 3>{round_down(0.1), -2.0F, 3.0F}));
    EXPECT_EQ(box.upper, (std::array<float, 3>{1.0F, round_up(0.3), 3.5F}));
}

}  // namespace
}  // namespace earshot::geometry
