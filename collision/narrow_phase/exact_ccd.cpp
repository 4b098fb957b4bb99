// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/exact_ccd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {

namespace {

using Vector = std::array<Polynomial, 3>;

Vector operator-(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Component `axis` of the cross product.
Polynomial cross(const Vector& a, const Vector& b, std::size_t axis) {
    const std::size_t i = (axis + 1) % 3;
    const std::size_t k = (axis + 2) % 3;
    return a[i] * b[k] - a[k] * b[i];
}

Vector cross(const Vector& a, const Vector& b) {
    return {cross(a, b, 0), cross(a, b, 1), cross(a, b, 2)};
}

Polynomial dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::array<Vector, 4> motions_of(const IntegerPoints& points) {
    std::array<Vector, 4> motions;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            motions[i][axis] =
                Polynomial(points.begin[i][axis], points.end[i][axis] - points.begin[i][axis]);
        }
    }
    return motions;
}

bool is_on_segment(const Vector& p, const Vector& a, const Vector& b, Root& at) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at.sign_of(cross(b - a, p - a, axis)) != 0) {
            return false;
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at.sign_of((p[axis] - a[axis]) * (b[axis] - p[axis])) < 0) {
            return false;
        }
    }
    return true;
}

/// The first axis along which a vector is not 0, and its sign there; axis 3: none.
struct Axis {
    std::size_t axis = 3;
    int sign = 0;
};

Axis axis_of(const Vector& vector, Root& at) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (const int sign = at.sign_of(vector[axis]); sign != 0) {
            return {axis, sign};
        }
    }
    return {};
}

/// Precondition: the four points are coplanar at that time.
bool is_in_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c, Root& at) {
    const auto [axis, sign] = axis_of(cross(b - a, c - a), at);
    if (axis == 3) {
        return is_on_segment(p, a, b, at) || is_on_segment(p, b, c, at) ||
               is_on_segment(p, c, a, at);
    }
    const auto is_inside = [&, axis = axis, sign = sign](const Vector& from, const Vector& to) {
        return sign * at.sign_of(cross(to - from, p - from, axis)) >= 0;
    };
    return is_inside(a, b) && is_inside(b, c) && is_inside(c, a);
}

/// Precondition: the four points are coplanar at that time.
bool segments_intersect(
    const Vector& a, const Vector& b, const Vector& c, const Vector& d, Root& at) {
    const std::size_t axis = axis_of(cross(b - a, d - c), at).axis;
    if (axis == 3) {
        return is_on_segment(a, c, d, at) || is_on_segment(b, c, d, at) ||
               is_on_segment(c, a, b, at) || is_on_segment(d, a, b, at);
    }
    const auto on_one_side =
        [&](const Vector& from, const Vector& to, const Vector& first, const Vector& second) {
            return at.sign_of(cross(to - from, first - from, axis)) *
                       at.sign_of(cross(to - from, second - from, axis)) >
                   0;
        };
    return !on_one_side(a, b, c, d) && !on_one_side(c, d, a, b);
}

/// The lower bound of the first root at which `holds`.
template <class Predicate>
std::optional<double> first_root(const Polynomial& polynomial, const Predicate& holds) {
    for (Root& root : Root::all_of(polynomial)) {
        if (holds(root)) {
            return root.lower_bound();
        }
    }
    return std::nullopt;
}

std::optional<double> earlier(std::optional<double> a, std::optional<double> b) {
    return !a || (b && *b < *a) ? b : a;
}

/// The first time at which a point is on a segment.
std::optional<double> reaches_segment(const Vector& p, const Vector& a, const Vector& b) {
    const auto holds = [&](Root& at) { return is_on_segment(p, a, b, at); };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Polynomial area = cross(b - a, p - a, axis);
        if (!area.is_zero()) {
            return first_root(area, holds);
        }
    }
    // Collinear at all times: the segment is entered at an end of it.
    std::optional<double> first;
    for (const Vector& end : {a, b}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Polynomial distance = p[axis] - end[axis];
            if (!distance.is_zero()) {
                first = earlier(first, first_root(distance, holds));
                break;
            }
        }
    }
    return first;
}

/// Time 0, the root of t.
Root beginning() {
    return Root::all_of(Polynomial(0, 1)).front();
}

}  // namespace

IntegerPoints integers_of(const MovingPoints& points) {
    int min_exponent = std::numeric_limits<int>::max();
    const auto for_each = [&](const auto& use) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                use(points.begin[i][axis], i, axis, false);
                use(points.end[i][axis], i, axis, true);
            }
        }
    };
    constexpr int kDigits = 53;
    for_each([&](double value, std::size_t, int, bool) {
        int exponent = 0;
        if (std::frexp(value, &exponent) != 0.0) {
            min_exponent = std::min(min_exponent, exponent - kDigits);
        }
    });
    IntegerPoints result;
    for_each([&](double value, std::size_t i, int axis, bool is_end) {
        int exponent = 0;
        const double fraction = std::frexp(value, &exponent);
        if (fraction != 0.0) {
            Integer& target =
                (is_end ? result.end : result.begin)[i][static_cast<std::size_t>(axis)];
            target = static_cast<std::int64_t>(std::ldexp(fraction, kDigits));
            target <<= static_cast<unsigned>(exponent - kDigits - min_exponent);
        }
    });
    return result;
}

std::optional<double> exact_vertex_face_ccd(const IntegerPoints& points) {
    const auto [p, a, b, c] = motions_of(points);
    const Polynomial volume = dot(cross(b - a, c - a), p - a);
    if (!volume.is_zero()) {
        return first_root(volume, [&, &p = p, &a = a, &b = b, &c = c](Root& at) {
            return is_in_triangle(p, a, b, c, at);
        });
    }
    // Coplanar at all times: inside from the beginning, or entering through an edge.
    Root start = beginning();
    if (is_in_triangle(p, a, b, c, start)) {
        return 0.0;
    }
    return earlier(earlier(reaches_segment(p, a, b), reaches_segment(p, b, c)),
                   reaches_segment(p, c, a));
}

std::optional<double> exact_edge_edge_ccd(const IntegerPoints& points) {
    const auto [a, b, c, d] = motions_of(points);
    const Polynomial volume = dot(cross(b - a, d - c), c - a);
    if (!volume.is_zero()) {
        return first_root(volume, [&, &a = a, &b = b, &c = c, &d = d](Root& at) {
            return segments_intersect(a, b, c, d, at);
        });
    }
    // Coplanar at all times: crossing from the beginning, or an end reaches the other segment.
    Root start = beginning();
    if (segments_intersect(a, b, c, d, start)) {
        return 0.0;
    }
    return earlier(earlier(reaches_segment(a, c, d), reaches_segment(b, c, d)),
                   earlier(reaches_segment(c, a, b), reaches_segment(d, a, b)));
}

}  // namespace earshot::collision
