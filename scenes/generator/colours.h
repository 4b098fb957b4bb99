// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace earshot::scenes {

// Linear red, green, blue of what the scenes are made of.
using Colour = std::array<double, 3>;
inline constexpr Colour kPlaster = {0.80, 0.77, 0.70};
inline constexpr Colour kConcrete = {0.45, 0.45, 0.44};
inline constexpr Colour kWood = {0.42, 0.24, 0.11};
inline constexpr Colour kDarkWood = {0.20, 0.10, 0.05};
inline constexpr Colour kGlass = {0.35, 0.55, 0.65};
inline constexpr Colour kRed = {0.45, 0.06, 0.06};
inline constexpr Colour kGreen = {0.06, 0.20, 0.12};
inline constexpr Colour kGrey = {0.30, 0.31, 0.33};
inline constexpr Colour kGold = {0.60, 0.42, 0.14};

}  // namespace earshot::scenes
