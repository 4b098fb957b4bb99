// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// A point of a picture: x to the right, y down, in the picture's units.
struct SvgPoint {
    double x = 0.0;
    double y = 0.0;
};

/// A linear axis of a diagram.
struct SvgAxis {
    double first = 0.0;  ///< value at `begin`
    double last = 1.0;   ///< value at `end`
    double begin = 0.0;  ///< coordinate in the picture
    double end = 1.0;
    std::vector<double> ticks{};  ///< values that are labelled
    std::string unit{};           ///< follows each label, with its space: " s"

    /// The coordinate of a value; the middle if the axis has no length.
    double at(double value) const noexcept;
};

struct SvgTextStyle {
    std::string fill = "black";
    std::string anchor = "start";  ///< start, middle, end
    double size = 0.0;             ///< 0: the picture's
    bool halo = false;             ///< white around the letters, where they stand on lines
};

/// The width of a text in a sans-serif font as wide as common ones get (DejaVu Sans), estimated:
/// fonts differ from viewer to viewer.
double svg_text_width(std::string_view text, double font_size) noexcept;

/// A picture in SVG 1.1, drawn in the order of the calls, one element per line. Coordinates are
/// rounded to a tenth of a unit; texts are escaped.
class SvgPicture {
public:
    /// On white. The title is what viewers show as the picture's name; empty: none.
    SvgPicture(double width, double height, double font_size, std::string_view title = {});

    void line(const SvgPoint& from, const SvgPoint& to, std::string_view stroke, double width = 1);
    void polyline(std::span<const SvgPoint> points, std::string_view stroke, double width = 1);
    /// Several separate polylines as one element; those of fewer than two points are left out.
    void polylines(std::span<const std::vector<SvgPoint>> lines,
                   std::string_view stroke,
                   double width = 1);
    /// Filled, without an outline; `title` as below.
    void rectangle(const SvgPoint& from,
                   const SvgPoint& to,
                   std::string_view fill,
                   std::string_view title = {});
    /// `title` is what viewers show when the pointer is over the disc; empty: none.
    void disc(const SvgPoint& centre,
              double radius,
              std::string_view fill,
              std::string_view title = {});
    void text(const SvgPoint& at, std::string_view text, const SvgTextStyle& style = {});
    /// The frame's left and lower side with the labels of the ticks. `y.begin` is the lower end.
    void axes(const SvgAxis& x, const SvgAxis& y);

    /// The whole document.
    std::string str() const { return body_ + "</svg>\n"; }

private:
    std::string body_;
};

}  // namespace earshot::io
