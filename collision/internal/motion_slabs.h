// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <span>

namespace earshot::collision {

/// What a moving triangle covers along thirteen directions (the axes and the diagonals of faces and
/// of the cube; the rest repeat one), at the beginning and at the end of a step, rounded outward.
struct MotionSlabs {
    static constexpr std::size_t kSlabs = 16;
    alignas(64) std::array<float, kSlabs> lower_begin, upper_begin, lower_end, upper_end;

    MotionSlabs() = default;
    /// `margin` is added along every axis.
    MotionSlabs(std::span<const geometry::Vec3, 3> begin,
                std::span<const geometry::Vec3, 3> end,
                double margin);
};

/// True only if the triangles never meet: along one direction the same lies beyond the other at
/// both ends, and so throughout, because places along a direction are linear in time.
inline bool are_apart(const MotionSlabs& a, const MotionSlabs& b) noexcept {
    int apart = 0;
    for (std::size_t i = 0; i < MotionSlabs::kSlabs; ++i) {
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
