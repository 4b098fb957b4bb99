// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

// Times of impact of moving points, in arbitrary-precision integers: polynomials in powers of time,
// their roots counted by Sturm's theorem, features tested by the signs of cross products at a root.
// Shares no code with the library, which works on Bernstein coefficients.
namespace earshot::test {

using Big = boost::multiprecision::cpp_int;
/// Coefficients of 1, t, t^2, ...; the last is not 0, and 0 has none.
using Poly = std::vector<Big>;

inline Poly trimmed(Poly p) {
    while (!p.empty() && p.back() == 0) {
        p.pop_back();
    }
    return p;
}
inline Poly operator-(const Poly& a, const Poly& b) {
    Poly result(std::max(a.size(), b.size()));
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = (i < a.size() ? a[i] : Big(0)) - (i < b.size() ? b[i] : Big(0));
    }
    return trimmed(std::move(result));
}
inline Poly operator*(const Poly& a, const Poly& b) {
    Poly result(a.empty() || b.empty() ? 0 : a.size() + b.size() - 1);
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = 0; k < b.size(); ++k) {
            result[i + k] += a[i] * b[k];
        }
    }
    return result;
}
inline Poly operator+(const Poly& a, const Poly& b) {
    return a - (Poly{Big(-1)} * b);
}
inline Poly derivative(const Poly& p) {
    Poly result;
    for (std::size_t i = 1; i < p.size(); ++i) {
        result.push_back(p[i] * i);
    }
    return result;
}
/// Divided by what all coefficients have in common.
inline Poly primitive(Poly p) {
    Big common = 0;
    for (const Big& c : p) {
        common = gcd(common, c);
    }
    for (Big& c : p) {
        c /= common;
    }
    return p;
}

struct Division {
    Poly quotient, remainder;  // of a positive multiple of the dividend
};

inline Division divided(Poly a, const Poly& b) {
    Division result;
    result.quotient.resize(a.size() < b.size() ? 0 : a.size() - b.size() + 1);
    const Big scale = abs(b.back());
    while (a.size() >= b.size()) {
        const Big factor = b.back() < 0 ? Big(-a.back()) : a.back();
        Poly term(a.size() - b.size() + 1);
        term.back() = factor;
        for (Big& c : result.quotient) {
            c *= scale;
        }
        result.quotient[a.size() - b.size()] += factor;
        a = (Poly{scale} * a) - (term * b);
    }
    result.remainder = std::move(a);
    return result;
}

inline Poly common_divisor(Poly a, Poly b) {
    while (!b.empty()) {
        a = primitive(divided(std::move(a), b).remainder);
        std::swap(a, b);
    }
    return a;
}

/// A time: numerator / 2^bits.
struct Dyadic {
    Big numerator;
    unsigned bits = 0;

    friend bool operator<(const Dyadic& a, const Dyadic& b) {
        return a.numerator << b.bits < b.numerator << a.bits;
    }

    double value() const {  // rounded down
        const int excess = numerator == 0 ? 0 : static_cast<int>(msb(numerator)) - 52;
        const Big top = excess > 0 ? Big(numerator >> static_cast<unsigned>(excess)) : numerator;
        return std::ldexp(top.convert_to<double>(), std::max(excess, 0) - static_cast<int>(bits));
    }
};

inline int sign_at(const Poly& p, const Dyadic& t) {
    Big sum = 0;
    for (std::size_t i = p.size(); i-- > 0;) {
        sum = sum * t.numerator + (p[i] << (t.bits * static_cast<unsigned>(p.size() - 1 - i)));
    }
    return sum.sign();
}

/// Counts the distinct roots of a polynomial.
class Sturm {
public:
    /// Precondition: not 0.
    explicit Sturm(const Poly& p) {
        chain_.push_back(primitive(p));
        if (p.size() > 1) {
            const Poly shared = common_divisor(chain_[0], derivative(chain_[0]));
            chain_[0] = primitive(divided(chain_[0], shared).quotient);
            chain_.push_back(derivative(chain_[0]));
        }
        while (chain_.back().size() > 1) {
            const Poly rest = divided(chain_[chain_.size() - 2], chain_.back()).remainder;
            chain_.push_back(primitive(Poly{Big(-1)} * rest));
        }
    }

    /// After `from` and up to `to`.
    int roots(const Dyadic& from, const Dyadic& to) const { return changes(from) - changes(to); }
    const Poly& square_free() const { return chain_[0]; }

private:
    int changes(const Dyadic& t) const {
        int last = 0, count = 0;
        for (const Poly& p : chain_) {
            const int sign = sign_at(p, t);
            count += sign != 0 && sign == -last ? 1 : 0;
            last = sign != 0 ? sign : last;
        }
        return count;
    }

    std::vector<Poly> chain_;
};

/// A root of a polynomial, the only one after `from` and up to `to`; or, without one, the time 0.
struct Instant {
    std::optional<Sturm> of{};
    Dyadic from{0, 0}, to{0, 0};

    void subdivide() {
        const Dyadic middle{from.numerator + to.numerator, from.bits + 1};
        const bool is_before = of->roots(from, middle) > 0;
        from = is_before ? Dyadic{from.numerator * 2, from.bits + 1} : middle;
        to = is_before ? middle : Dyadic{to.numerator * 2, to.bits + 1};
    }

    int sign_of(const Poly& p) const {
        if (p.empty() || !of) {
            return p.empty() ? 0 : p[0].sign();
        }
        const Sturm other(p);
        if (other.roots(from, to) == 0) {
            return sign_at(p, to);
        }
        const Poly shared = common_divisor(p, of->square_free());
        if (shared.size() > 1 && Sturm(shared).roots(from, to) > 0) {
            return 0;
        }
        Instant nearer = *this;
        while (other.roots(nearer.from, nearer.to) > 0) {
            nearer.subdivide();
        }
        return sign_at(p, nearer.to);
    }
};

inline void append_roots(const Sturm& of, Dyadic from, Dyadic to, std::vector<Instant>& into) {
    const int count = of.roots(from, to);
    if (count == 1) {
        into.push_back({of, from, to});
        while (into.back().to.bits < 64) {
            into.back().subdivide();
        }
    } else if (count > 1) {
        const Dyadic middle{from.numerator + to.numerator, from.bits + 1};
        append_roots(of, {from.numerator * 2, from.bits + 1}, middle, into);
        append_roots(of, middle, {to.numerator * 2, to.bits + 1}, into);
    }
}

/// The roots in (0, 1] in their order; none of the polynomial 0.
inline std::vector<Instant> roots_of(const Poly& p) {
    std::vector<Instant> roots;
    if (p.size() > 1) {
        append_roots(Sturm(p), {0, 0}, {1, 0}, roots);
    }
    return roots;
}

using PolyVec = std::array<Poly, 3>;

inline PolyVec operator-(const PolyVec& a, const PolyVec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Poly cross(const PolyVec& a, const PolyVec& b, std::size_t axis) {
    const std::size_t i = (axis + 1) % 3, k = (axis + 2) % 3;
    return a[i] * b[k] - a[k] * b[i];
}
inline Poly dot(const PolyVec& a, const PolyVec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Four points whose places are whole numbers times one unit.
class MovingWholes {
public:
    explicit MovingWholes(const collision::MovingPoints& points) {
        int unit = 2000;
        for (const auto* at : {&points.begin, &points.end}) {
            for (const geometry::Vec3& x : *at) {
                for (int k = 0; k < 3; ++k) {
                    int exponent = 0;
                    unit =
                        std::frexp(x[k], &exponent) != 0.0 ? std::min(unit, exponent - 53) : unit;
                }
            }
        }
        const auto whole = [unit](double value) {
            int exponent = 0;
            const double digits = std::ldexp(std::frexp(value, &exponent), 53);
            return value == 0.0 ? Big(0)
                                : Big(Big(digits) << static_cast<unsigned>(exponent - 53 - unit));
        };
        for (std::size_t i = 0; i < 4; ++i) {
            for (int k = 0; k < 3; ++k) {
                const Big begin = whole(points.begin[i][k]), end = whole(points.end[i][k]);
                x_[i][static_cast<std::size_t>(k)] = trimmed({begin, Big(end - begin)});
            }
        }
    }

    Poly volume() const {
        const PolyVec a = x_[1] - x_[0], b = x_[2] - x_[0], c = x_[3] - x_[0];
        return dot({cross(a, b, 0), cross(a, b, 1), cross(a, b, 2)}, c);
    }

    /// What decides whether points in a plane touch: no contact begins or ends between its roots.
    std::vector<Poly> planar_events() const {
        std::vector<Poly> events;
        for (std::size_t p = 0; p < 4; ++p) {
            for (std::size_t a = 0; a < 4; ++a) {
                for (std::size_t b = a + 1; b < 4; ++b) {
                    if (a != p && b != p) {
                        events.push_back(primitive(dot(x_[a] - x_[p], x_[b] - x_[p])));
                        for (std::size_t axis = 0; axis < 3; ++axis) {
                            events.push_back(primitive(side(p, a, b, axis)));
                        }
                    }
                }
            }
        }
        std::sort(events.begin(), events.end());
        events.erase(std::unique(events.begin(), events.end()), events.end());
        return events;
    }

    /// Whether the features touch at a time at which all points lie in a plane.
    bool touch(const Instant& at, bool is_face) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto sign = [&](std::size_t p, std::size_t a, std::size_t b) {
                return at.sign_of(side(p, a, b, axis));
            };
            if (is_face) {
                if (const int area = sign(1, 2, 3)) {
                    return sign(0, 1, 2) != -area && sign(0, 2, 3) != -area &&
                           sign(0, 3, 1) != -area;
                }
            } else if (at.sign_of(cross(x_[1] - x_[0], x_[3] - x_[2], axis)) != 0) {
                return sign(2, 0, 1) * sign(3, 0, 1) <= 0 && sign(0, 2, 3) * sign(1, 2, 3) <= 0;
            }
        }
        const auto on = [&](std::size_t p, std::size_t a, std::size_t b) {
            return at.sign_of(side(p, a, b, 0)) == 0 && at.sign_of(side(p, a, b, 1)) == 0 &&
                   at.sign_of(side(p, a, b, 2)) == 0 &&
                   at.sign_of(dot(x_[a] - x_[p], x_[b] - x_[p])) <= 0;
        };
        return is_face ? on(0, 1, 2) || on(0, 2, 3) || on(0, 3, 1)
                       : on(0, 2, 3) || on(1, 2, 3) || on(2, 0, 1) || on(3, 0, 1);
    }

private:
    /// Of p, beside the line from a to b, looked at along an axis.
    Poly side(std::size_t p, std::size_t a, std::size_t b, std::size_t axis) const {
        return cross(x_[a] - x_[p], x_[b] - x_[p], axis);
    }

    std::array<PolyVec, 4> x_;
};

/// The first contact, after `from` and up to `to` (both 0 if it is there at the beginning), which
/// are at most 2^-64 apart.
inline std::optional<Instant> first_touch(const collision::MovingPoints& points, bool is_face) {
    const MovingWholes wholes(points);
    const Poly volume = wholes.volume();
    if ((volume.empty() || volume[0] == 0) && wholes.touch({}, is_face)) {
        return Instant{};
    }
    std::optional<Instant> first;
    for (const Poly& event :
         volume.empty() ? wholes.planar_events() : std::vector<Poly>(1, volume)) {
        for (const Instant& root : roots_of(event)) {
            if (first && first->to < root.to) {
                break;
            }
            if (wholes.touch(root, is_face)) {
                first = root;
                break;
            }
        }
    }
    return first;
}

}  // namespace earshot::test
