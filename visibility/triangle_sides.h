// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstdint>

namespace earshot::visibility {

/// One of the two sides of a triangle: 2 * triangle for its front (counter-clockwise), + 1 for its
/// back. It looks into the half-space before it.
using SideId = std::uint32_t;

constexpr SideId front_of(geometry::TriangleId triangle) noexcept {
    return 2 * triangle;
}
constexpr SideId back_of(geometry::TriangleId triangle) noexcept {
    return 2 * triangle + 1;
}
constexpr SideId opposite(SideId side) noexcept {
    return side ^ 1U;
}
constexpr geometry::TriangleId triangle_of(SideId side) noexcept {
    return side / 2;
}
constexpr bool is_back(SideId side) noexcept {
    return side % 2 != 0;
}

}  // namespace earshot::visibility
