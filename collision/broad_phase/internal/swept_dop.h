// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>

namespace earshot::collision {

/// Thirteen directions (the axes and the diagonals of faces and of the cube; the rest repeat one).
inline constexpr std::size_t kSlabs = 16;

/// Where a vertex is along them at the beginning and at the end of a step, rounded.
struct MotionPlaces {
    alignas(64) std::array<float, kSlabs> begin, end;

    MotionPlaces() = default;
    MotionPlaces(const geometry::Vec3& from, const geometry::Vec3& to);
};

/// What a moving triangle covers along them, rounded outward.
struct MotionSlabs {
    alignas(64) std::array<float, kSlabs> lower_begin, upper_begin, lower_end, upper_end;

    MotionSlabs() = default;
    /// `margin` is added along every axis.
    MotionSlabs(const MotionPlaces& a,
                const MotionPlaces& b,
                const MotionPlaces& c,
                double margin) noexcept;
};

/// True only if the triangles never meet: along one direction the same lies beyond the other at
/// both ends, and so throughout, because places along a direction are linear in time.
inline bool are_apart(const MotionSlabs& a, const MotionSlabs& b) noexcept {
    int apart = 0;
    for (std::size_t i = 0; i < kSlabs; ++i) {
        apart |= ((a.lower_begin[i] > b.upper_begin[i]) & (a.lower_end[i] > b.upper_end[i])) |
                 ((b.lower_begin[i] > a.upper_begin[i]) & (b.lower_end[i] > a.upper_end[i]));
    }
    return apart != 0;
}

/// The corners of a triangle at both ends of a step.
struct MovingCorners {
    std::array<geometry::Vec3, 3> begin, end;
};

/// The same along the normal that `a` has half-way: tells apart layers that lie close. `margin` as
/// above.
bool are_apart_along_normal(const MovingCorners& a, const MovingCorners& b, double margin) noexcept;

}  // namespace earshot::collision
