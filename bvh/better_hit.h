// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <concepts>

namespace earshot::bvh {

/// Something that a ray or segment hits at a parameter t: a hit, a blocker.
template <class Type>
concept TriangleHit = requires(const Type& hit) {
    { hit.t } -> std::convertible_to<double>;
    { hit.triangle } -> std::convertible_to<geometry::TriangleId>;
};

/// The one order of hits: by t, and at the same t by TriangleId. Every search for a closest hit
/// decides ties by it, which is why no tree, thread count or instruction set changes an answer.
template <TriangleHit Type>
constexpr bool better_hit(const Type& a, const Type& b) noexcept {
    return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
}

}  // namespace earshot::bvh
