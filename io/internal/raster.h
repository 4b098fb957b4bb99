// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/png.h"
#include "earshot/io/svg.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace earshot::io {

/// Red, green and blue (sRGB).
using Rgb = std::array<std::uint8_t, 3>;

/// Draws into the pixels of a picture, x to the right and y down, in pixels. What lies outside is
/// left out; there is no smoothing of edges.
class Raster {
public:
    /// White. Precondition: the sides are 1 ... kMaxPictureSize.
    Raster(std::size_t width, std::size_t height);

    void rectangle(const SvgPoint& from, const SvgPoint& to, const Rgb& fill);
    void line(const SvgPoint& from, const SvgPoint& to, const Rgb& stroke, double width = 1.0);
    void disc(const SvgPoint& centre, double radius, const Rgb& fill);
    /// Letters of 10 x 14 pixels above the base line at `at`, which is the left end, the middle or
    /// the right end for the anchors start, middle and end. Characters but those of ASCII are shown
    /// as boxes.
    void text(const SvgPoint& at, std::string_view text, std::string_view anchor, const Rgb& fill);

    const Picture& picture() const noexcept { return picture_; }

private:
    void set(long x, long y, const Rgb& colour);

    Picture picture_;
};

}  // namespace earshot::io
