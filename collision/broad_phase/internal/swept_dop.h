// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <span>

namespace earshot::collision {

/// Lanes of a 26-DOP: thirteen directions (three axes, six face diagonals and four cube diagonals);
/// the remaining lanes repeat an axis.
inline constexpr std::size_t kDopLanes = 16;

/// Projections of a vertex onto the directions at the beginning and at the end of a step, rounded.
struct DopExtents {
    alignas(64) std::array<float, kDopLanes> begin, end;

    DopExtents() = default;
    DopExtents(const geometry::Vec3& from, const geometry::Vec3& to);
};

/// Swept 26-DOP of a moving triangle (Klosowski et al. 1998): its extents along the directions at
/// both ends of a step, rounded outward.
struct SweptDop {
    alignas(64) std::array<float, kDopLanes> lower_begin, upper_begin, lower_end, upper_end;

    SweptDop() = default;
    /// `margin` is added along every axis.
    SweptDop(const DopExtents& a, const DopExtents& b, const DopExtents& c, double margin) noexcept;
};

/// True only if the triangles are disjoint during the whole step: along one direction the same one
/// lies beyond the other at both ends, and so at all times, because projections are linear in time.
inline bool disjoint(const SweptDop& a, const SweptDop& b) noexcept {
    int separated = 0;
    for (std::size_t i = 0; i < kDopLanes; ++i) {
        separated |= ((a.lower_begin[i] > b.upper_begin[i]) & (a.lower_end[i] > b.upper_end[i])) |
                     ((b.lower_begin[i] > a.upper_begin[i]) & (b.lower_end[i] > a.upper_end[i]));
    }
    return separated != 0;
}

/// The corners of a triangle at both ends of a step.
struct MovingCorners {
    std::array<geometry::Vec3, 3> begin, end;
};

/// The same test along the normal of `a` half-way through the step, which separates close layers.
/// `margin` as in SweptDop.
bool disjoint_along_normal(const MovingCorners& a, const MovingCorners& b, double margin) noexcept;

/// The corners of an element at both ends of a step.
struct MovingElement {
    std::span<const geometry::Vec3> begin, end;
};

/// A lower bound of the time within the step at which the boxes of two elements first overlap; more
/// than 1 if they do not.
double first_overlap(const MovingElement& a, const MovingElement& b) noexcept;

}  // namespace earshot::collision
