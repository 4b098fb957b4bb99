// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace earshot::collision {

// Elementary queries whose answer is known because they are made from it.

inline geometry::Vec3 random_point(support::Dice& dice) {
    return {dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0)};
}

/// A contact made to measure: at time t the first point lies at (u, v) of the triangle, or the
/// segments cross at u and v. Coordinates are multiples of 2^-20, t of 2^-4, u and v of 2^-2, so
/// that everything is exact.
struct MadeContact {
    MovingPoints points;
    double time;
};

inline double coarse(double value, double step) {
    return std::round(value / step) * step;
}

inline geometry::Vec3 coarse_point(support::Dice& dice) {
    const geometry::Vec3 p = random_point(dice);
    constexpr double kStep = 0x1p-12;
    return {coarse(p.x, kStep), coarse(p.y, kStep), coarse(p.z, kStep)};
}

/// Point 0 passes `impact` at `time` with a random velocity.
inline void pass(const geometry::Vec3& impact,
                 double time,
                 support::Dice& dice,
                 geometry::Vec3& begin,
                 geometry::Vec3& end) {
    const geometry::Vec3 velocity = coarse_point(dice);
    begin = impact - time * velocity;
    end = impact + (1.0 - time) * velocity;
}

inline MadeContact made_contact(support::Dice& dice, bool is_face) {
    MadeContact made;
    made.time = dice.below(17) / 16.0;
    const double u = dice.below(5) / 4.0;
    const double v =
        is_face ? dice.below(static_cast<int>(4.0 * (1.0 - u)) + 1) / 4.0 : dice.below(5) / 4.0;
    for (std::size_t i = 1; i < 4; ++i) {
        made.points.begin[i] = coarse_point(dice);
        made.points.end[i] = coarse_point(dice);
    }
    const auto at = [&](std::size_t i) {
        return made.points.begin[i] + made.time * (made.points.end[i] - made.points.begin[i]);
    };
    if (is_face) {
        pass(at(1) + u * (at(2) - at(1)) + v * (at(3) - at(1)),
             made.time,
             dice,
             made.points.begin[0],
             made.points.end[0]);
    } else {
        // a + u (b - a) = m: a = (m - u b) / (1 - u), or b = m if u is 1.
        const geometry::Vec3 impact = at(2) + v * (at(3) - at(2));
        if (u < 1.0) {
            const double one_minus = 1.0 - u;
            const double rest = one_minus == 0.75 ? 0.5 : one_minus;  // keeps the division exact
            const double weight = 1.0 - rest;
            pass((impact - weight * at(1)) / rest,
                 made.time,
                 dice,
                 made.points.begin[0],
                 made.points.end[0]);
        } else {
            pass(impact, made.time, dice, made.points.begin[1], made.points.end[1]);
            made.points.begin[0] = coarse_point(dice);
            made.points.end[0] = coarse_point(dice);
        }
    }
    return made;
}

/// A linear map with small whole numbers, often singular: what touches does so after it.
inline std::array<geometry::Vec3, 3> small_map(support::Dice& dice) {
    std::array<geometry::Vec3, 3> rows;
    for (geometry::Vec3& row : rows) {
        row = {dice.below(3) - 1.0, dice.below(3) - 1.0, dice.below(3) - 1.0};
    }
    return rows;
}

/// The same contact made hard: features flattened onto a plane, a line or a point for all times,
/// corners that coincide, far from the origin, huge or tiny.
inline MadeContact hard_contact(support::Dice& dice, bool is_face) {
    MadeContact made = made_contact(dice, is_face);
    const auto rows = small_map(dice);
    const double scale = std::ldexp(1.0, dice.below(5) * 40 - 80);
    const geometry::Vec3 offset =
        dice.chance(0.3) ? 0x1p10 * coarse_point(dice) : geometry::Vec3(0.0);
    const geometry::Vec3 wind = dice.chance(0.3) ? coarse_point(dice) : geometry::Vec3(0.0);
    const auto hardened = [&](const geometry::Vec3& p, const geometry::Vec3& shift) {
        geometry::Vec3 mapped;
        for (int axis = 0; axis < 3; ++axis) {
            const geometry::Vec3& row = rows[static_cast<std::size_t>(axis)];
            mapped[axis] = row.x * p.x + row.y * p.y + row.z * p.z;
        }
        return scale * (mapped + shift);
    };
    for (std::size_t i = 0; i < 4; ++i) {
        made.points.begin[i] = hardened(made.points.begin[i], offset);
        made.points.end[i] = hardened(made.points.end[i], offset + wind);
    }
    return made;
}

/// Features that a plane keeps apart by a hair throughout: a plane with a normal of small whole
/// numbers that stands at other places at the beginning and at the end.
inline MovingPoints near_miss(support::Dice& dice, bool is_face) {
    MovingPoints points;
    geometry::Vec3 normal(0.0);
    while (normal == geometry::Vec3(0.0)) {
        normal = {dice.below(3) - 1.0, dice.below(3) - 1.0, dice.below(3) - 1.0};
    }
    const std::size_t first = is_face ? 1 : 2;  // vertices of the first feature
    const auto rows = small_map(dice);
    for (auto* at : {&points.begin, &points.end}) {
        double upper = -1e300, lower = 1e300;
        for (std::size_t i = 0; i < 4; ++i) {
            const geometry::Vec3 p = coarse_point(dice);
            for (int axis = 0; axis < 3; ++axis) {
                const geometry::Vec3& row = rows[static_cast<std::size_t>(axis)];
                (*at)[i][axis] = row.x * p.x + row.y * p.y + row.z * p.z;
            }
            const double place =
                normal.x * (*at)[i].x + normal.y * (*at)[i].y + normal.z * (*at)[i].z;
            (i < first ? upper : lower) =
                i < first ? std::max(upper, place) : std::min(lower, place);
        }
        // Along the normal by as much as takes the first feature a hair below the other's lowest.
        const double length = normal.x * normal.x + normal.y * normal.y + normal.z * normal.z;
        const double quantum = 0x1p-40;
        const double way = std::floor((lower - upper) / length / quantum - 1.0) * quantum;
        for (std::size_t i = 0; i < first; ++i) {
            (*at)[i] += way * normal;
        }
    }
    return points;
}

}  // namespace earshot::collision
