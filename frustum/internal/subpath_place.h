// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::frustum {

inline constexpr std::size_t kPlaceCoordinates = 6;

/// A subpath as a point: the centres of its bounds. As large as eight floats.
struct alignas(32) SubpathPlace {
    std::array<float, kPlaceCoordinates> coordinate{};
    std::uint32_t number = 0;
    std::uint32_t unused = 0;
};

/// The coordinate in which places differ most, the first of equals, and from where to where.
struct Spread {
    std::size_t axis = 0;
    float lower = 0.0F, upper = 0.0F;
};

/// Precondition: there are places. The same on every instruction set.
Spread widest_spread(std::span<const SubpathPlace> places) noexcept;

}  // namespace earshot::frustum
