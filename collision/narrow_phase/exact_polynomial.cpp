// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/exact_polynomial.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>

namespace earshot::collision {

namespace {

int sign(const Integer& value) {
    return value.sign();
}

Integer content_of(const Polynomial& p) {
    Integer content = 0;
    for (int i = 0; i <= p.degree; ++i) {
        content = gcd(content, p.c[static_cast<std::size_t>(i)]);
    }
    return content;
}

void make_primitive(Polynomial& p) {
    if (p.is_zero()) {
        return;
    }
    const Integer content = content_of(p);
    for (int i = 0; i <= p.degree; ++i) {
        p.c[static_cast<std::size_t>(i)] /= content;
    }
}

const Integer& leading(const Polynomial& p) {
    return p.c[static_cast<std::size_t>(p.degree)];
}

/// The remainder of a, times a power of b's leading coefficient, divided by b. Precondition: b is
/// not zero.
Polynomial pseudo_remainder(Polynomial a, const Polynomial& b) {
    while (a.degree >= b.degree) {
        const Integer factor = leading(a);
        const auto shift = static_cast<std::size_t>(a.degree - b.degree);
        for (Integer& coefficient : a.c) {
            coefficient *= leading(b);
        }
        for (std::size_t i = 0; i <= static_cast<std::size_t>(b.degree); ++i) {
            a.c[i + shift] -= factor * b.c[i];
        }
        a.trim();
    }
    return a;
}

Polynomial common_divisor(Polynomial a, Polynomial b) {
    make_primitive(a);
    make_primitive(b);
    while (!b.is_zero()) {
        Polynomial rest = pseudo_remainder(a, b);
        make_primitive(rest);
        a = std::move(b);
        b = std::move(rest);
    }
    return a;
}

/// Precondition: the primitive b divides the primitive a.
Polynomial quotient(Polynomial a, const Polynomial& b) {
    Polynomial result;
    while (a.degree >= b.degree) {
        const auto shift = static_cast<std::size_t>(a.degree - b.degree);
        const Integer factor = leading(a) / leading(b);
        result.c[shift] = factor;
        for (std::size_t i = 0; i <= static_cast<std::size_t>(b.degree); ++i) {
            a.c[i + shift] -= factor * b.c[i];
        }
        a.trim();
    }
    result.trim();
    return result;
}

Polynomial derivative(const Polynomial& p) {
    Polynomial result;
    for (std::size_t i = 1; i < p.c.size(); ++i) {
        result.c[i - 1] = static_cast<int>(i) * p.c[i];
    }
    result.trim();
    return result;
}

/// Three times the Bernstein coefficients of a polynomial over [0, 1].
std::array<Integer, 4> bernstein(const Polynomial& p) {
    return {3 * p.c[0],
            3 * p.c[0] + p.c[1],
            3 * p.c[0] + 2 * p.c[1] + p.c[2],
            3 * (p.c[0] + p.c[1] + p.c[2] + p.c[3])};
}

/// Coefficients over the lower and the upper half, both times 8 (de Casteljau).
std::pair<std::array<Integer, 4>, std::array<Integer, 4>> subdivided(
    const std::array<Integer, 4>& b) {
    const Integer b01 = b[0] + b[1];
    const Integer b12 = b[1] + b[2];
    const Integer b23 = b[2] + b[3];
    const Integer b012 = b01 + b12;
    const Integer b123 = b12 + b23;
    const Integer middle = b012 + b123;
    return {{8 * b[0], 4 * b01, 2 * b012, middle}, {middle, 2 * b123, 4 * b23, 8 * b[3]}};
}

int sign_changes(const std::array<Integer, 4>& b) {
    int changes = 0;
    int last = 0;
    for (const Integer& value : b) {
        const int s = sign(value);
        changes += s != 0 && last != 0 && s != last ? 1 : 0;
        last = s != 0 ? s : last;
    }
    return changes;
}

/// The sign of p at index / 2^depth, from its value times 2^(depth * degree).
int sign_at(const Polynomial& p, const Integer& index, unsigned depth) {
    if (p.is_zero()) {
        return 0;
    }
    Integer value = leading(p);
    for (int i = p.degree - 1; i >= 0; --i) {
        value = value * index +
                (p.c[static_cast<std::size_t>(i)] << (depth * static_cast<unsigned>(p.degree - i)));
    }
    return sign(value);
}

}  // namespace

Polynomial::Polynomial(Integer constant, Integer linear) {
    c[0] = std::move(constant);
    c[1] = std::move(linear);
    trim();
}

void Polynomial::trim() {
    degree = 3;
    while (degree >= 0 && c[static_cast<std::size_t>(degree)].is_zero()) {
        --degree;
    }
}

Polynomial operator+(const Polynomial& a, const Polynomial& b) {
    Polynomial result;
    for (std::size_t i = 0; i < result.c.size(); ++i) {
        result.c[i] = a.c[i] + b.c[i];
    }
    result.trim();
    return result;
}

Polynomial operator-(const Polynomial& a, const Polynomial& b) {
    Polynomial result;
    for (std::size_t i = 0; i < result.c.size(); ++i) {
        result.c[i] = a.c[i] - b.c[i];
    }
    result.trim();
    return result;
}

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    EARSHOT_ASSERT(a.is_zero() || b.is_zero() || a.degree + b.degree <= 3);
    Polynomial result;
    for (int i = 0; i <= a.degree; ++i) {
        for (int k = 0; k <= b.degree; ++k) {
            result.c[static_cast<std::size_t>(i + k)] +=
                a.c[static_cast<std::size_t>(i)] * b.c[static_cast<std::size_t>(k)];
        }
    }
    result.trim();
    return result;
}

std::vector<Root> Root::all_of(const Polynomial& polynomial) {
    EARSHOT_ASSERT(!polynomial.is_zero());
    std::vector<Root> roots;
    if (polynomial.degree == 0) {
        return roots;
    }
    Root whole;
    whole.polynomial_ = polynomial;
    make_primitive(whole.polynomial_);
    const Polynomial repeated = common_divisor(whole.polynomial_, derivative(whole.polynomial_));
    if (repeated.degree > 0) {
        whole.polynomial_ = quotient(whole.polynomial_, repeated);
    }
    whole.bernstein_ = bernstein(whole.polynomial_);
    // Descartes' rule of signs on Bernstein coefficients isolates the roots; the stack holds
    // intervals, the earliest on top.
    std::vector<Root> stack{whole};
    const auto add_if_zero = [&](const Integer& value, const Integer& index, unsigned depth) {
        if (value.is_zero()) {
            Root root = whole;
            root.index_ = index;
            root.depth_ = depth;
            root.is_exact_ = true;
            roots.push_back(std::move(root));
        }
    };
    add_if_zero(whole.bernstein_[0], 0, 0);
    while (!stack.empty()) {
        Root interval = std::move(stack.back());
        stack.pop_back();
        const int changes = sign_changes(interval.bernstein_);
        const bool ends_in_zero =
            interval.bernstein_[0].is_zero() || interval.bernstein_[3].is_zero();
        if (changes == 1 && !ends_in_zero) {
            roots.push_back(interval);
        } else if (changes > 0) {
            const auto [lower, upper] = subdivided(interval.bernstein_);
            Root second = interval;
            second.bernstein_ = upper;
            interval.bernstein_ = lower;
            interval.index_ = 2 * interval.index_;
            second.index_ = interval.index_ + 1;
            interval.depth_ = ++second.depth_;
            stack.push_back(std::move(second));
            stack.push_back(std::move(interval));
            continue;
        }
        add_if_zero(interval.bernstein_[3], interval.index_ + 1, interval.depth_);
    }
    return roots;
}

void Root::bisect() {
    const auto [lower, upper] = subdivided(bernstein_);
    index_ = 2 * index_;
    ++depth_;
    if (lower[3].is_zero()) {
        ++index_;
        is_exact_ = true;
    } else if (sign(lower[0]) != sign(lower[3])) {
        bernstein_ = lower;
    } else {
        ++index_;
        bernstein_ = upper;
    }
}

int Root::sign_at_end(const Polynomial& polynomial, int offset) const {
    return sign_at(polynomial, index_ + offset, depth_);
}

int Root::sign_of(const Polynomial& polynomial) {
    constexpr int kMaxTries = 12;
    bool may_be_zero = true;
    for (int tries = 0;; ++tries) {
        if (is_exact_ || polynomial.degree <= 0) {
            return sign_at_end(polynomial, 0);
        }
        // Of degree 2 at most: it has one sign over the interval if it has it at both ends and at
        // the intersection of the end tangents (the middle Bernstein coefficient).
        const int low = sign_at_end(polynomial, 0);
        const int high = sign_at_end(polynomial, 1);
        if (low == high && low != 0) {
            // p(l) + p'(l) w / 2 = c0 + c1 l + c2 l^2 + (c1 + 2 c2 l) w / 2 with w = 2^-depth.
            const Integer middle = (polynomial.c[0] << (2 * depth_ + 1)) +
                                   (polynomial.c[1] << depth_) * (2 * index_ + 1) +
                                   2 * polynomial.c[2] * index_ * (index_ + 1);
            if (sign(middle) == low) {
                return low;
            }
        }
        if (tries >= kMaxTries && may_be_zero) {
            const Polynomial common = common_divisor(polynomial_, polynomial);
            if (common.degree > 0 && sign_at_end(common, 0) != sign_at_end(common, 1)) {
                return 0;
            }
            may_be_zero = false;
        }
        bisect();
    }
}

double Root::lower_bound() {
    constexpr unsigned kDepth = 50;
    while (!is_exact_ && depth_ < kDepth) {
        bisect();
    }
    // The quotient may have more digits than a double: it is truncated, not rounded.
    const unsigned excess = depth_ > kDepth ? depth_ - kDepth : 0;
    const Integer index = index_ >> excess;
    return std::ldexp(index.convert_to<double>(), -static_cast<int>(depth_ - excess));
}

}  // namespace earshot::collision
