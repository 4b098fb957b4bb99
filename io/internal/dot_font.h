// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace earshot::io {

/// Rows from the top down, 5 dots each: bit 4 is the left one.
inline constexpr std::size_t kGlyphColumns = 5, kGlyphRows = 7;
using DotGlyph = std::array<std::uint8_t, kGlyphRows>;

/// A box for what is not a character of ASCII with a glyph.
const DotGlyph& dot_glyph(char character) noexcept;

}  // namespace earshot::io
