// SPDX-License-Identifier: MIT
#include "earshot/geometry/predicates.h"

#include "earshot/base/error_free.h"
#include "earshot/geometry/internal/exact_sum.h"

#include <array>
#include <cmath>

namespace earshot::geometry {
namespace {

// Both predicates: first in plain doubles, with a bound on the error relative to the "permanent",
// the same sum with all its terms taken positive; if the result is within the bound, exactly, on
// differences that are pairs of doubles and hence exact too.
//
// The bounds (Shewchuk 1997, sections 4.3 and 4.4) count the roundings on the way of each term to
// the result: every difference, product and sum adds a factor 1 +- kHalfUlp.
constexpr double kHalfUlp = 0x1p-53;
// Two differences and a product per term, one subtraction: (1 + e)^4 - 1, of which the last
// rounding does not change the sign of the result; the excess over 3 e covers squares of e and the
// rounding of the bound itself.
constexpr double kOrient2dBound = (3.0 + 16.0 * kHalfUlp) * kHalfUlp;
// Three differences and two products per term, three sums, the last of which again keeps the sign.
constexpr double kOrient3dBound = (7.0 + 56.0 * kHalfUlp) * kHalfUlp;

int sign(double value) noexcept {
    return (value > 0.0 ? 1 : 0) - (value < 0.0 ? 1 : 0);
}

/// a - b exactly: lower part first.
std::array<double, 2> difference(double a, double b) noexcept {
    const DoublePair pair = two_sum(a, -b);
    return {pair.lo, pair.hi};
}

/// Adds factor * x * y to the sum.
template <std::size_t Capacity>
void add_products(ExactSum<Capacity>& sum,
                  double factor,
                  const std::array<double, 2>& x,
                  const std::array<double, 2>& y) noexcept {
    for (const double p : x) {
        for (const double q : y) {
            sum.add_product(factor * p, q);
        }
    }
}

/// p q' - p' q of two pairs of differences: at most 2 * 4 products of two numbers.
using Minor = ExactSum<16>;
Minor minor_of(const std::array<double, 2>& p_x,
               const std::array<double, 2>& p_y,
               const std::array<double, 2>& q_x,
               const std::array<double, 2>& q_y) noexcept {
    Minor sum;
    add_products(sum, 1.0, p_x, q_y);
    add_products(sum, -1.0, q_x, p_y);
    return sum;
}

double determinant2d_exactly(const glm::dvec2& a,
                             const glm::dvec2& b,
                             const glm::dvec2& c) noexcept {
    return minor_of(difference(a.x, c.x),
                    difference(a.y, c.y),
                    difference(b.x, c.x),
                    difference(b.y, c.y))
        .estimate();
}

double determinant3d_exactly(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
    const std::array<const Vec3*, 3> corners{&a, &b, &c};
    std::array<std::array<std::array<double, 2>, 3>, 3> rows{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<int>(axis);
            rows[row][axis] = difference((*corners[row])[k], d[k]);
        }
    }
    // Three minors of at most 16 components, each times a pair of z: 3 * 16 * 2 products.
    ExactSum<192> determinant;
    for (std::size_t row = 0; row < 3; ++row) {
        const auto& p = rows[(row + 1) % 3];
        const auto& q = rows[(row + 2) % 3];
        const Minor minor = minor_of(p[0], p[1], q[0], q[1]);
        for (const double z : rows[row][2]) {
            if (z == 0.0) {
                continue;
            }
            for (const double component : minor.components()) {
                determinant.add_product(component, z);
            }
        }
    }
    return determinant.estimate();
}

/// A determinant in plain doubles, and its permanent.
struct Rounded {
    double determinant = 0.0;
    double permanent = 0.0;

    // A permanent of 0 leaves no term to be rounded: all points lie in one axis-aligned plane, say.
    bool is_beyond(double fraction) const noexcept {
        return std::abs(determinant) > fraction * permanent || permanent == 0.0;
    }
};

Rounded round2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    return {left - right, std::abs(left) + std::abs(right)};
}

Rounded round3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
    const Vec3 p = a - d;
    const Vec3 q = b - d;
    const Vec3 r = c - d;
    const double qr = q.x * r.y;
    const double rq = r.x * q.y;
    const double rp = r.x * p.y;
    const double pr = p.x * r.y;
    const double pq = p.x * q.y;
    const double qp = q.x * p.y;
    return {p.z * (qr - rq) + q.z * (rp - pr) + r.z * (pq - qp),
            (std::abs(qr) + std::abs(rq)) * std::abs(p.z) +
                (std::abs(rp) + std::abs(pr)) * std::abs(q.z) +
                (std::abs(pq) + std::abs(qp)) * std::abs(r.z)};
}

// Above this fraction of the permanent a determinant in plain doubles, off by less than 2^-49 of
// the permanent, is off by less than 2^-39 of itself.
constexpr double kPreciseShare = 0x1p-10;

}  // namespace

int orient2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept {
    const Rounded rounded = round2d(a, b, c);
    return sign(rounded.is_beyond(kOrient2dBound) ? rounded.determinant
                                                  : determinant2d_exactly(a, b, c));
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
    const Rounded rounded = round3d(a, b, c, d);
    return sign(rounded.is_beyond(kOrient3dBound) ? rounded.determinant
                                                  : determinant3d_exactly(a, b, c, d));
}

// The components of the normal are twice the areas of the three projections.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) != 0 ||
           orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) != 0 ||
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) != 0;
}

double determinant2d(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept {
    const Rounded rounded = round2d(a, b, c);
    return rounded.is_beyond(kPreciseShare) ? rounded.determinant : determinant2d_exactly(a, b, c);
}

double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
    const Rounded rounded = round3d(a, b, c, d);
    return rounded.is_beyond(kPreciseShare) ? rounded.determinant
                                            : determinant3d_exactly(a, b, c, d);
}

Vec3 without_tiny_coordinates(const Vec3& point) noexcept {
    const auto flushed = [](double x) { return std::abs(x) < kMinCoordinate ? 0.0 : x; };
    return {flushed(point.x), flushed(point.y), flushed(point.z)};
}

}  // namespace earshot::geometry
