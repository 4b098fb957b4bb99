// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/rational_ccd.h"

#include "earshot/collision/narrow_phase/internal/exact_ccd.h"

#include <cmath>
#include <utility>

namespace earshot::collision {

namespace {

Integer integer_of(const std::string& digits) {
    return Integer(digits);
}

std::optional<double> as_double(const Rational& value) {
    Integer numerator = integer_of(value.numerator);
    Integer denominator = integer_of(value.denominator);
    const Integer common = gcd(numerator, denominator);
    numerator /= common;
    denominator /= common;
    if (numerator.is_zero()) {
        return 0.0;
    }
    const Integer size = abs(numerator);
    const auto zeros = static_cast<int>(lsb(size));
    const auto exponent = static_cast<int>(msb(denominator));
    constexpr int kDigits = 53;
    constexpr int kMinExponent = -1074;
    constexpr int kMaxExponent = 1023;
    if (lsb(denominator) != msb(denominator) || static_cast<int>(msb(size)) - zeros >= kDigits ||
        zeros - exponent < kMinExponent || static_cast<int>(msb(size)) - exponent > kMaxExponent) {
        return std::nullopt;
    }
    const Integer odd = size >> static_cast<unsigned>(zeros);
    const double magnitude = std::ldexp(odd.convert_to<double>(), zeros - exponent);
    return numerator.sign() < 0 ? -magnitude : magnitude;
}

/// Over a common denominator, which changes no decision.
IntegerPoints integers_of(const RationalPoints& points) {
    Integer common = 1;
    for (const auto* at : {&points.begin, &points.end}) {
        for (const auto& point : *at) {
            for (const Rational& value : point) {
                common = lcm(common, integer_of(value.denominator));
            }
        }
    }
    IntegerPoints result;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto scaled = [&](const Rational& value) {
                return integer_of(value.numerator) * (common / integer_of(value.denominator));
            };
            result.begin[i][axis] = scaled(points.begin[i][axis]);
            result.end[i][axis] = scaled(points.end[i][axis]);
        }
    }
    return result;
}

}  // namespace

std::optional<MovingPoints> as_doubles(const RationalPoints& points) {
    MovingPoints result;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto begin = as_double(points.begin[i][axis]);
            const auto end = as_double(points.end[i][axis]);
            if (!begin || !end) {
                return std::nullopt;
            }
            result.begin[i][static_cast<int>(axis)] = *begin;
            result.end[i][static_cast<int>(axis)] = *end;
        }
    }
    return result;
}

std::optional<double> vertex_face_ccd(const RationalPoints& points) {
    return exact_vertex_face_ccd(integers_of(points));
}

std::optional<double> edge_edge_ccd(const RationalPoints& points) {
    return exact_edge_edge_ccd(integers_of(points));
}

}  // namespace earshot::collision
