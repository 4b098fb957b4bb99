// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/triangle_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/collision/narrow_phase/triangle_lanes_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

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
    return {{a.at[0] - b.at[0], a.at[1] - b.at[1], a.at[2] - b.at[2]}};
}
HWY_INLINE Doubles dot(const Vector& a, const Vector& b) {
    return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}
HWY_INLINE Vector abs(const Vector& a) {
    return {{abs(a.at[0]), abs(a.at[1]), abs(a.at[2])}};
}
HWY_INLINE Vector select(const Doubles::Mask& mask, const Vector& yes, const Vector& no) {
    return {{select(mask, yes.at[0], no.at[0]),
             select(mask, yes.at[1], no.at[1]),
             select(mask, yes.at[2], no.at[2])}};
}

/// A vector product and, as a bound for its rounding, the same with all its terms positive.
struct Product {
    Vector exact, permanent;

    HWY_INLINE Product(const Vector& u, const Vector& v) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i = (k + 1) % 3;
            const std::size_t j = (k + 2) % 3;
            const Doubles forth = u.at[i] * v.at[j];
            const Doubles back = u.at[j] * v.at[i];
            exact.at[k] = forth - back;
            permanent.at[k] = abs(forth) + abs(back);
        }
    }
};

/// Where a determinant certainly has a sign; neither if it is within its rounding of 0.
struct Sign {
    Doubles::Mask positive, negative;

    /// Of the product's component along w.
    HWY_INLINE Sign(const Product& product, const Vector& w) {
        const Doubles determinant = dot(product.exact, w);
        const Doubles bound = Doubles(kBound) * dot(product.permanent, abs(w));
        positive = bound < determinant;
        negative = determinant < Doubles(0.0) - bound;
    }
};

/// How a triangle's corners lie about another's plane, and the one that is alone on its side.
struct Sides {
    Doubles::Mask is_one_sided, is_certain;
    Doubles::Mask is_second_lone, is_third_lone, is_lone_above;

    HWY_INLINE Sides(const Triangle& plane, const Triangle& points) {
        const Product normal(plane.corner[1] - plane.corner[0], plane.corner[2] - plane.corner[0]);
        const Sign a(normal, points.corner[0] - plane.corner[0]);
        const Sign b(normal, points.corner[1] - plane.corner[0]);
        const Sign c(normal, points.corner[2] - plane.corner[0]);
        is_one_sided =
            (a.positive & b.positive & c.positive) | (a.negative & b.negative & c.negative);
        is_certain =
            (a.positive | a.negative) & (b.positive | b.negative) & (c.positive | c.negative);
        is_third_lone = (a.positive & b.positive) | (a.negative & b.negative);
        is_second_lone = (a.positive & c.positive) | (a.negative & c.negative);
        is_lone_above =
            select(is_third_lone, c.positive, select(is_second_lone, b.positive, a.positive));
    }
};

/// The triangle turned so that its lone corner is the first, and turned round where asked.
HWY_INLINE Triangle in_order(const Triangle& t, const Sides& sides, const Doubles::Mask& is_round) {
    const auto& [a, b, c] = t.corner;
    const Doubles::Mask& second = sides.is_second_lone;
    const Doubles::Mask& third = sides.is_third_lone;
    const Vector next = select(third, a, select(second, c, b));
    const Vector last = select(third, b, select(second, a, c));
    return {{select(third, c, select(second, b, a)),
             select(is_round, next, last),
             select(is_round, last, next)}};
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
    const std::uint32_t one_sided = bits(one_sides.is_one_sided | other_sides.is_one_sided);
    const std::uint32_t crossing = bits(one_sides.is_certain & other_sides.is_certain) & ~one_sided;
    return {one_sided | (crossing & bits(first.negative | last.positive)),
            crossing & bits(first.positive & last.negative)};
}

HWY_INLINE Triangle transformed(const double (&corners)[3][3][TriangleLanes::kWidth],
                                std::size_t lane,
                                const Pose& pose) {
    Triangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const Doubles x = Doubles::load(&corners[corner][0][lane]);
        const Doubles y = Doubles::load(&corners[corner][1][lane]);
        const Doubles z = Doubles::load(&corners[corner][2][lane]);
        for (int k = 0; k < 3; ++k) {
            // In the order of Pose::apply().
            const auto term = [&](int axis, const Doubles& p) {
                return Doubles(pose.rotation[axis][k]) * p;
            };
            triangle.corner[corner].at[k] =
                term(0, x) + term(1, y) + term(2, z) + Doubles(pose.translation[k]);
        }
    }
    return triangle;
}

LanesDecided decide(const TriangleLanes& pairs, const Pose& one, const Pose& other) {
    LanesDecided all;
    for (std::size_t lane = 0; lane < TriangleLanes::kWidth; lane += Doubles::kCount) {
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
