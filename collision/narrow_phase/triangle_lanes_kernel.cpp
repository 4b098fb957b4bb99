// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/triangle_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/collision/narrow_phase/triangle_lanes_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::collision::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;  // NOLINT: the wide types

// Of orient3d(): three differences and two products per term, three sums (Shewchuk 1997).
constexpr double kBound = (7.0 + 56.0 * 0x1p-53) * 0x1p-53;

struct Vector {
    Doubles at[3];
};
struct Triangle {
    Vector corner[3];
};

HWY_INLINE Vector operator-(const Vector& a, const Vector& b) {
    return {{subtract(a.at[0], b.at[0]), subtract(a.at[1], b.at[1]), subtract(a.at[2], b.at[2])}};
}
HWY_INLINE Doubles dot(const Vector& a, const Vector& b) {
    return add(add(multiply(a.at[0], b.at[0]), multiply(a.at[1], b.at[1])),
               multiply(a.at[2], b.at[2]));
}
HWY_INLINE Vector magnitude(const Vector& a) {
    return {{absolute(a.at[0]), absolute(a.at[1]), absolute(a.at[2])}};
}
HWY_INLINE Vector chosen(const DoublesMask& mask, const Vector& yes, const Vector& no) {
    return {{choose(mask, yes.at[0], no.at[0]),
             choose(mask, yes.at[1], no.at[1]),
             choose(mask, yes.at[2], no.at[2])}};
}

/// A vector product and, as a bound for its rounding, the same with all its terms positive.
struct Product {
    Vector exact, permanent;

    HWY_INLINE Product(const Vector& u, const Vector& v) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3;
            const std::size_t j = (k + 2) % 3;
            const Doubles forth = multiply(u.at[i], v.at[j]);
            const Doubles back = multiply(u.at[j], v.at[i]);
            exact.at[k] = subtract(forth, back);
            permanent.at[k] = add(absolute(forth), absolute(back));
        }
    }
};

/// Where a determinant certainly has a sign; neither if it is within its rounding of 0.
struct Sign {
    DoublesMask positive, negative;

    /// Of the product's component along w.
    HWY_INLINE Sign(const Product& product, const Vector& w) {
        const Doubles determinant = dot(product.exact, w);
        const Doubles bound = multiply(broadcast(kBound), dot(product.permanent, magnitude(w)));
        positive = below(bound, determinant);
        negative = below(determinant, subtract(broadcast(0.0), bound));
    }
};

/// How a triangle's corners lie about another's plane, and the one that is alone on its side.
struct Sides {
    DoublesMask is_one_sided, is_certain;
    DoublesMask is_second_lone, is_third_lone, is_lone_above;

    HWY_INLINE Sides(const Triangle& plane, const Triangle& points) {
        const Product normal(plane.corner[1] - plane.corner[0], plane.corner[2] - plane.corner[0]);
        const Sign a(normal, points.corner[0] - plane.corner[0]);
        const Sign b(normal, points.corner[1] - plane.corner[0]);
        const Sign c(normal, points.corner[2] - plane.corner[0]);
        is_one_sided = either(both(both(a.positive, b.positive), c.positive),
                              both(both(a.negative, b.negative), c.negative));
        is_certain = both(both(either(a.positive, a.negative), either(b.positive, b.negative)),
                          either(c.positive, c.negative));
        is_third_lone = either(both(a.positive, b.positive), both(a.negative, b.negative));
        is_second_lone = either(both(a.positive, c.positive), both(a.negative, c.negative));
        is_lone_above =
            choose(is_third_lone, c.positive, choose(is_second_lone, b.positive, a.positive));
    }
};

/// The triangle turned so that its lone corner is the first, and turned round where asked.
HWY_INLINE Triangle in_order(const Triangle& t, const Sides& sides, const DoublesMask& is_round) {
    const auto& [a, b, c] = t.corner;
    const DoublesMask& second = sides.is_second_lone;
    const DoublesMask& third = sides.is_third_lone;
    const Vector next = chosen(third, a, chosen(second, c, b));
    const Vector last = chosen(third, b, chosen(second, a, c));
    return {{chosen(third, c, chosen(second, b, a)),
             chosen(is_round, next, last),
             chosen(is_round, last, next)}};
}

/// The sign of orient3d().
HWY_INLINE Sign orientation(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
    return {Product(a - d, b - d), c - d};
}

/// As intersect() does, with what is certain: see Crossing in triangle_intersection.cpp.
HWY_INLINE LanesDecided decided(const Triangle& one, const Triangle& other) {
    const Sides one_sides(other, one);
    const Sides other_sides(one, other);
    const Triangle a = in_order(one, one_sides, other_sides.is_lone_above);
    const Triangle b = in_order(other, other_sides, one_sides.is_lone_above);
    const Sign first = orientation(a.corner[0], a.corner[1], b.corner[0], b.corner[1]);
    const Sign last = orientation(a.corner[0], a.corner[2], b.corner[0], b.corner[2]);
    const std::uint32_t one_sided = bits(either(one_sides.is_one_sided, other_sides.is_one_sided));
    const std::uint32_t crossing =
        bits(both(one_sides.is_certain, other_sides.is_certain)) & ~one_sided;
    return {one_sided | (crossing & bits(either(first.negative, last.positive))),
            crossing & bits(both(first.positive, last.negative))};
}

HWY_INLINE Triangle transformed(const double (&corners)[3][3][TriangleLanes::kWidth],
                                std::size_t lane,
                                const Pose& pose) {
    Triangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const Doubles x = load(&corners[corner][0][lane]);
        const Doubles y = load(&corners[corner][1][lane]);
        const Doubles z = load(&corners[corner][2][lane]);
        for (int k = 0; k < 3; ++k) {
            // In the order of Pose::apply().
            const auto term = [&](int axis, const Doubles& p) {
                return multiply(broadcast(pose.rotation[axis][k]), p);
            };
            triangle.corner[corner].at[k] =
                add(add(add(term(0, x), term(1, y)), term(2, z)), broadcast(pose.translation[k]));
        }
    }
    return triangle;
}

LanesDecided decide(const TriangleLanes& pairs, const Pose& one, const Pose& other) {
    LanesDecided all;
    for (std::size_t lane = 0; lane < TriangleLanes::kWidth; lane += lanes()) {
        const LanesDecided some =
            decided(transformed(pairs.one, lane, one), transformed(pairs.other, lane, other));
        all.disjoint |= some.disjoint << lane;
        all.intersecting |= some.intersecting << lane;
    }
    return all;
}

}  // namespace earshot::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::collision {

HWY_EXPORT(decide);

LanesDecided decide_lanes(const TriangleLanes& pairs, const Pose& one, const Pose& other) {
    return HWY_DYNAMIC_DISPATCH(decide)(pairs, one, other);
}

}  // namespace earshot::collision
#endif
