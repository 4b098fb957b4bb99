// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>
#include <utility>
#include <vector>

namespace earshot::collision {

/// Arbitrary-precision integers; up to 512 bits without an allocation.
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<512, 0>,
                                              boost::multiprecision::et_off>;

/// A polynomial in t of degree 3 at most, lowest power first.
struct Polynomial {
    std::array<Integer, 4> c{};
    int degree = -1;  ///< of the highest power that is not 0; -1: zero

    Polynomial() = default;
    Polynomial(Integer constant, Integer linear);

    bool is_zero() const { return degree < 0; }
    void trim();
};

Polynomial operator+(const Polynomial& a, const Polynomial& b);
Polynomial operator-(const Polynomial& a, const Polynomial& b);
/// Precondition: the product has degree 3 at most.
Polynomial operator*(const Polynomial& a, const Polynomial& b);

/// A real root of a polynomial in [0, 1], isolated from the others by an interval.
class Root {
public:
    /// The distinct roots in [0, 1], in order. Precondition: not zero.
    static std::vector<Root> all_of(const Polynomial& polynomial);

    /// -1, 0, 1: of another polynomial at this root, exactly.
    int sign_of(const Polynomial& polynomial);

    /// A lower bound of the root, within 2^-50.
    double lower_bound();

private:
    void bisect();
    int sign_at_end(const Polynomial& polynomial, int offset) const;

    Polynomial polynomial_;             // square-free
    std::array<Integer, 4> bernstein_;  // its Bernstein coefficients over the interval, scaled
    Integer index_ = 0;                 // the interval is index / 2^depth ... (index + 1) / 2^depth
    unsigned depth_ = 0;
    bool is_exact_ = false;  // the root is index / 2^depth
};

}  // namespace earshot::collision
