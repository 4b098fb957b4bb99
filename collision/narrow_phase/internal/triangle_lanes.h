// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/shape.h"

#include <cstddef>
#include <cstdint>

namespace earshot::collision {

/// Eight pairs of triangles in SIMD lanes, each triangle in its body's space.
struct TriangleLanes {
    static constexpr std::size_t kWidth = 8;

    alignas(64) double one[3][3][kWidth];  // one[corner][axis]
    alignas(64) double other[3][3][kWidth];

    void set(std::size_t lane, const Corners& first, const Corners& second) noexcept {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto k = static_cast<int>(axis);
                one[corner][axis][lane] = first[corner][k];
                other[corner][axis][lane] = second[corner][k];
            }
        }
    }
};

/// The pairs that are certainly disjoint or intersecting: bit i stands for lane i. The others are
/// left to intersect().
struct LanesDecided {
    std::uint32_t disjoint = 0, intersecting = 0;

    friend bool operator==(const LanesDecided&, const LanesDecided&) = default;
};

/// Decides with the filters of intersect(), in doubles, whether triangles meet where Pose::apply()
/// puts them; compiled for every instruction set. Preconditions as intersect().
LanesDecided decide_lanes(const TriangleLanes& pairs, const Pose& one, const Pose& other);

}  // namespace earshot::collision
