// SPDX-License-Identifier: MIT
#include "earshot/geometry/predicates.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace earshot::geometry {
namespace {

constexpr std::uint64_t kSeed = 11;

/// The oracle: sums of products of doubles as whole numbers in base 2^24, one digit per power.
class BigSum {
public:
    void add(std::initializer_list<double> factors, int sign) {
        // The product as integer * 2^exponent, by schoolbook multiplication of 53-bit integers.
        Digits digits{{0, sign}};
        int exponent = kOffset;
        for (const double factor : factors) {
            int e = 0;
            const auto integer = static_cast<std::int64_t>(std::ldexp(std::frexp(factor, &e), 53));
            exponent += e - 53;
            Digits next;
            for (const auto& [power, digit] : digits) {
                next[power] += digit * (integer % kBase);
                next[power + 1] += digit * (integer / kBase % kBase);
                next[power + 2] += digit * (integer / kBase / kBase);
            }
            digits = carried(next);
        }
        for (const auto& [power, digit] : digits) {
            total_[power + exponent / 24] += digit * (std::int64_t{1} << (exponent % 24));
        }
    }

    int sign() const {
        const Digits digits = carried(total_);
        for (auto it = digits.rbegin(); it != digits.rend(); ++it) {
            if (it->second != 0) {
                return it->second > 0 ? 1 : -1;
            }
        }
        return 0;
    }

    /// Rounded, from the top digit down, so that digits that cancel do so exactly.
    double value() const {
        const Digits digits = carried(total_);
        long double value = 0.0L;
        for (auto it = digits.rbegin(); it != digits.rend(); ++it) {
            value += std::ldexp(static_cast<long double>(it->second), 24 * it->first - kOffset);
        }
        return static_cast<double>(value);
    }

private:
    using Digits = std::map<int, std::int64_t>;
    static constexpr std::int64_t kBase = std::int64_t{1} << 24;
    static constexpr int kOffset = 2400;  // keeps every exponent positive

    /// Every digit but the top one in [0, base), so that the top one has the sign.
    static Digits carried(Digits digits) {
        for (auto it = digits.begin(); it != digits.end(); ++it) {
            std::int64_t carry = it->second / kBase;
            carry -= it->second < carry * kBase ? 1 : 0;
            const bool is_top = std::next(it) == digits.end();
            if (carry != 0 && !(is_top && carry == -1)) {
                it->second -= carry * kBase;
                digits[it->first + 1] += carry;
            }
        }
        return digits;
    }

    Digits total_;
};

BigSum exact_determinant2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    BigSum sum;
    sum.add({a.x, b.y}, 1);
    sum.add({a.y, b.x}, -1);
    sum.add({b.x, c.y}, 1);
    sum.add({b.y, c.x}, -1);
    sum.add({c.x, a.y}, 1);
    sum.add({c.y, a.x}, -1);
    return sum;
}

/// The 4 x 4 determinant with rows (x, y, z, 1), expanded over all permutations of three points.
BigSum exact_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    BigSum sum;
    const auto add_triple = [&sum](const Vec3& p, const Vec3& q, const Vec3& r, int sign) {
        sum.add({p.x, q.y, r.z}, sign);
        sum.add({p.y, q.z, r.x}, sign);
        sum.add({p.z, q.x, r.y}, sign);
        sum.add({p.x, q.z, r.y}, -sign);
        sum.add({p.y, q.x, r.z}, -sign);
        sum.add({p.z, q.y, r.x}, -sign);
    };
    add_triple(a, b, c, 1);
    add_triple(b, c, d, -1);
    add_triple(c, d, a, 1);
    add_triple(d, a, b, -1);
    return sum;
}

int exact_orient2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return exact_determinant2d(a, b, c).sign();
}

int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return exact_determinant3d(a, b, c, d).sign();
}

/// As far as determinants may be off, relatively.
constexpr double kPrecision = 0x1p-39;

double steps_up(double x, int steps) {
    for (int i = 0; i < std::abs(steps); ++i) {
        x = std::nextafter(x, steps > 0 ? 1e300 : -1e300);
    }
    return x;
}

double random_coordinate(std::uint64_t stream, std::uint64_t index) {
    const double exponent = std::floor(random_between(kSeed, stream + 50, index, -40.0, 40.0));
    return std::ldexp(random_between(kSeed, stream, index, -1.0, 1.0), static_cast<int>(exponent));
}

Vec3 random_point(std::uint64_t stream, std::uint64_t index) {
    return {random_between(kSeed, stream, index, -10.0, 10.0),
            random_between(kSeed, stream + 1, index, -10.0, 10.0),
            random_between(kSeed, stream + 2, index, -10.0, 10.0)};
}

TEST(Orient2d, TellsLeftFromRight) {
    EXPECT_EQ(orient2d({0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}), 1);
    EXPECT_EQ(orient2d({0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}), -1);
    EXPECT_EQ(orient2d({0.0, 0.0}, {1.0, 1.0}, {3.0, 3.0}), 0);
    EXPECT_EQ(orient2d({0.5, 0.5}, {0.5, 0.5}, {3.0, 7.0}), 0);
}

TEST(Orient2d, IsExactAroundALine) {
    // Kettner et al. 2008, figure 2: a grid of neighbouring doubles around a point of a line.
    const glm::dvec2 b(12.0, 12.0);
    const glm::dvec2 c(24.0, 24.0);
    for (int i = -12; i <= 12; ++i) {
        for (int j = -12; j <= 12; ++j) {
            const glm::dvec2 a(steps_up(0.5, i), steps_up(0.5, j));
            ASSERT_EQ(orient2d(a, b, c), exact_orient2d(a, b, c)) << i << ' ' << j;
        }
    }
}

TEST(Orient2d, AgreesWithExactIntegersOnNearlyCollinearPoints) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const glm::dvec2 a(random_coordinate(0, i), random_coordinate(1, i));
        const glm::dvec2 b(random_coordinate(2, i), random_coordinate(3, i));
        const double t = random_between(kSeed, 4, i, -2.0, 2.0);
        const auto step = static_cast<int>(random_bits(kSeed, 5, i) % 3) - 1;
        const glm::dvec2 c(a.x + t * (b.x - a.x), steps_up(a.y + t * (b.y - a.y), step));
        const int want = exact_orient2d(a, b, c);
        ASSERT_EQ(orient2d(a, b, c), want) << "seed " << kSeed << " index " << i;
        ASSERT_EQ(orient2d(b, a, c), -want) << i;
        ASSERT_EQ(orient2d(c, a, b), want) << i;
    }
}

TEST(Orient3d, IsPositiveBelowAPlaneThatRunsCounterClockwise) {
    const Vec3 a(0.0, 0.0, 0.0);
    const Vec3 b(1.0, 0.0, 0.0);
    const Vec3 c(0.0, 1.0, 0.0);
    EXPECT_EQ(orient3d(a, b, c, {0.2, 0.2, -1.0}), 1);
    EXPECT_EQ(orient3d(a, b, c, {0.2, 0.2, 1.0}), -1);
    EXPECT_EQ(orient3d(a, b, c, {5.0, -7.0, 0.0}), 0);
}

TEST(Orient3d, FindsPointsOfAnAxisAlignedPlaneCoplanar) {
    for (int axis = 0; axis < 3; ++axis) {
        for (std::uint64_t i = 0; i < 100; ++i) {
            std::array<Vec3, 4> p{};
            for (std::uint64_t k = 0; k < 4; ++k) {
                p[k] = random_point(10 * k, i);
                p[k][axis] = 0.1;
            }
            ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), 0) << axis << ' ' << i;
            p[3][axis] = steps_up(0.1, 1);
            ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), exact_orient3d(p[0], p[1], p[2], p[3]));
        }
    }
}

TEST(Orient3d, IsExactAroundAPointOfAPlane) {
    // The plane x + y + z = 24, and a grid of neighbouring doubles around (0.5, 0.5, 23).
    const Vec3 a(24.0, 0.0, 0.0);
    const Vec3 b(0.0, 24.0, 0.0);
    const Vec3 c(0.1, 0.2, 24.0 - 0.1 - 0.2);
    for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
            for (int k = -1; k <= 1; ++k) {
                const Vec3 d(steps_up(0.5, i), steps_up(0.5, j), steps_up(23.0, k));
                ASSERT_EQ(orient3d(a, b, c, d), exact_orient3d(a, b, c, d)) << i << j << k;
            }
        }
    }
}

TEST(Orient3d, AgreesWithExactIntegersOnNearlyCoplanarPoints) {
    int zeros = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const Vec3 a = random_point(60, i);
        const Vec3 b = random_point(63, i);
        const Vec3 c = random_point(66, i);
        // Weights that are short binary fractions make some of the points exactly coplanar.
        const double s = std::floor(random_between(kSeed, 69, i, -4.0, 4.0)) / 4.0;
        const double t = std::floor(random_between(kSeed, 70, i, -4.0, 4.0)) / 4.0;
        const Vec3 d = a + s * (b - a) + t * (c - a);
        const int want = exact_orient3d(a, b, c, d);
        zeros += want == 0 ? 1 : 0;
        ASSERT_EQ(orient3d(a, b, c, d), want) << "seed " << kSeed << " index " << i;
        ASSERT_EQ(orient3d(b, a, c, d), -want) << i;
        ASSERT_EQ(orient3d(a, b, d, c), -want) << i;
        ASSERT_EQ(orient3d(b, c, a, d), want) << i;
        ASSERT_EQ(orient3d(d, a, b, c), -want) << i;
    }
    EXPECT_GT(zeros, 10);
    EXPECT_LT(zeros, 2990);
}

TEST(Orient3d, IsExactOverTheWholeRangeOfThePrecondition) {
    // Coordinates whose differences are no doubles: the exact stage has to work on pairs.
    for (std::uint64_t i = 0; i < 500; ++i) {
        std::array<Vec3, 4> p{};
        for (std::uint64_t k = 0; k < 4; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                const std::uint64_t stream = 200 + 3 * k + static_cast<std::uint64_t>(axis);
                const double e = std::floor(random_between(kSeed, stream, i, -290.0, 290.0));
                p[k][axis] = std::ldexp(random_between(kSeed, stream + 50, i, -1.0, 1.0),
                                        static_cast<int>(e));
            }
        }
        p[3] = p[static_cast<std::size_t>(i % 3)];
        p[3].z = steps_up(p[3].z, static_cast<int>(i % 5) - 2);
        ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3]), exact_orient3d(p[0], p[1], p[2], p[3]))
            << "seed " << kSeed << " index " << i;
    }
}

TEST(HasArea, AgreesWithWholeNumbers) {
    std::size_t flat = 0;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        std::array<std::array<std::int64_t, 3>, 3> p{};
        for (std::size_t k = 0; k < 9; ++k) {
            p[k / 3][k % 3] = static_cast<std::int64_t>(random_between(kSeed, 80 + k, i, 0.0, 3.0));
        }
        const auto side = [&](std::size_t corner, std::size_t axis) {
            return p[corner][axis] - p[0][axis];
        };
        bool is_flat = true;
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t y = (x + 1) % 3;
            is_flat = is_flat && side(1, x) * side(2, y) == side(1, y) * side(2, x);
        }
        const auto vec = [&](std::size_t corner) {
            return Vec3(static_cast<double>(p[corner][0]),
                        static_cast<double>(p[corner][1]),
                        static_cast<double>(p[corner][2]));
        };
        ASSERT_EQ(has_area(vec(0), vec(1), vec(2)), !is_flat) << i;
        flat += is_flat ? 1 : 0;
    }
    EXPECT_GT(flat, 100U);
    // 0.1 times 1, 2, 3 is not on a line in doubles.
    EXPECT_TRUE(has_area({0.0, 0.0, 1.0}, {0.1, 0.1, 1.0}, {0.1 * 3.0, 0.3, 1.0}));
}

TEST(Determinant2d, IsPreciseOnNearlyCollinearPoints) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const glm::dvec2 a(random_coordinate(0, i), random_coordinate(1, i));
        const glm::dvec2 b(random_coordinate(2, i), random_coordinate(3, i));
        const double t = random_between(kSeed, 4, i, -2.0, 2.0);
        const glm::dvec2 c(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
        const double want = exact_determinant2d(a, b, c).value();
        ASSERT_NEAR(determinant2d(a, b, c), want, kPrecision * std::abs(want)) << i;
    }
    EXPECT_EQ(determinant2d({0.0, 0.0}, {1.0, 0.0}, {0.0, 3.0}), 3.0);
}

TEST(Determinant3d, IsPreciseOnNearlyCoplanarPoints) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const Vec3 a = random_point(60, i);
        const Vec3 b = random_point(63, i);
        const Vec3 c = random_point(66, i);
        const Vec3 d = a + random(kSeed, 70, i) * (b - a) + random(kSeed, 71, i) * (c - a);
        const double want = exact_determinant3d(a, b, c, d).value();
        ASSERT_NEAR(determinant3d(a, b, c, d), want, kPrecision * std::abs(want)) << i;
        const Vec3 far = d + random_point(72, i);
        const double large = exact_determinant3d(a, b, c, far).value();
        ASSERT_NEAR(determinant3d(a, b, c, far), large, kPrecision * std::abs(large)) << i;
    }
}

}  // namespace
}  // namespace earshot::geometry
