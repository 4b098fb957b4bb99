// SPDX-License-Identifier: MIT
#include "earshot/io/internal/raster.h"

#include "earshot/io/internal/dot_font.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace earshot::io {

namespace {

constexpr long kDot = 2;  // pixels along a dot of a letter
constexpr long kAdvance = (static_cast<long>(kGlyphColumns) + 1) * kDot;

long nearest(double value) {
    return std::lround(value);
}

/// One character for each code point of UTF-8.
std::string letters_of(std::string_view text) {
    std::string letters;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80U || byte >= 0xC0U) {
            letters += c;
        }
    }
    return letters;
}

}  // namespace

Raster::Raster(std::size_t width, std::size_t height) {
    constexpr std::uint8_t kWhite = 255;
    picture_.width = width;
    picture_.height = height;
    picture_.rgb.assign(3 * width * height, kWhite);
}

void Raster::set(long x, long y, const Rgb& colour) {
    if (x >= 0 && y >= 0 && x < static_cast<long>(picture_.width) &&
        y < static_cast<long>(picture_.height)) {
        const auto pixel =
            static_cast<std::size_t>(y) * picture_.width + static_cast<std::size_t>(x);
        std::copy(colour.begin(),
                  colour.end(),
                  picture_.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
    }
}

void Raster::rectangle(const SvgPoint& from, const SvgPoint& to, const Rgb& fill) {
    const long x0 = std::max(0L, nearest(std::min(from.x, to.x)));
    const long y0 = std::max(0L, nearest(std::min(from.y, to.y)));
    const long x1 = std::min(static_cast<long>(picture_.width), nearest(std::max(from.x, to.x)));
    const long y1 = std::min(static_cast<long>(picture_.height), nearest(std::max(from.y, to.y)));
    for (long y = y0; y < y1; ++y) {
        for (long x = x0; x < x1; ++x) {
            set(x, y, fill);
        }
    }
}

void Raster::disc(const SvgPoint& centre, double radius, const Rgb& fill) {
    for (long y = nearest(centre.y - radius); y <= nearest(centre.y + radius); ++y) {
        for (long x = nearest(centre.x - radius); x <= nearest(centre.x + radius); ++x) {
            const double dx = static_cast<double>(x) - centre.x;
            const double dy = static_cast<double>(y) - centre.y;
            if (dx * dx + dy * dy <= radius * radius) {
                set(x, y, fill);
            }
        }
    }
}

// Discs along the line, half a pixel apart.
void Raster::line(const SvgPoint& from, const SvgPoint& to, const Rgb& stroke, double width) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const double steps = std::ceil(2.0 * length) + 1.0;
    for (double i = 0.0; i <= steps; i += 1.0) {
        const SvgPoint at = {from.x + (to.x - from.x) * i / steps,
                             from.y + (to.y - from.y) * i / steps};
        if (width > 1.0) {
            disc(at, 0.5 * width, stroke);
        } else {
            set(nearest(at.x), nearest(at.y), stroke);
        }
    }
}

void Raster::text(const SvgPoint& at,
                  std::string_view text,
                  std::string_view anchor,
                  const Rgb& fill) {
    const std::string letters = letters_of(text);
    const long length = static_cast<long>(letters.size()) * kAdvance - kDot;
    const long left = nearest(at.x) - (anchor == "end"      ? length
                                       : anchor == "middle" ? length / 2
                                                            : 0);
    const long top = nearest(at.y) - static_cast<long>(kGlyphRows) * kDot;
    for (std::size_t i = 0; i < letters.size(); ++i) {
        const DotGlyph& glyph = dot_glyph(letters[i]);
        for (long row = 0; row < static_cast<long>(kGlyphRows) * kDot; ++row) {
            for (long column = 0; column < static_cast<long>(kGlyphColumns) * kDot; ++column) {
                const long bit = static_cast<long>(kGlyphColumns) - 1 - column / kDot;
                if ((glyph[static_cast<std::size_t>(row / kDot)] >> bit & 1U) != 0U) {
                    set(left + static_cast<long>(i) * kAdvance + column, top + row, fill);
                }
            }
        }
    }
}

}  // namespace earshot::io
