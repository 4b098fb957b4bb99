// SPDX-License-Identifier: MIT
#include "earshot/io/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace earshot::io {
namespace {

/// To a tenth, without a fraction where it is whole.
std::string number(double value) {
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%.1f", value);
    std::string text = buffer.data();
    if (text.ends_with(".0")) {
        text.resize(text.size() - 2);
    }
    return text == "-0" ? "0" : text;
}

std::string label(double value) {
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%.3g", value + 0.0);  // not -0
    return buffer.data();
}

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string attribute(std::string_view name, std::string_view value) {
    return " " + std::string(name) + "=\"" + escaped(value) + "\"";
}

std::string stroke_width(double width) {
    return width == 1.0 ? std::string() : attribute("stroke-width", number(width));
}

/// Path data: move to the first point, lines to the others.
std::string path_data(std::span<const SvgPoint> points) {
    std::string data;
    for (const SvgPoint& point : points) {
        data += (data.empty() ? "M" : "L") + number(point.x) + " " + number(point.y);
    }
    return data;
}

std::string path(std::string_view data, std::string_view stroke, double width) {
    return "<path fill=\"none\"" + attribute("stroke", stroke) + stroke_width(width) +
           attribute("d", data) + "/>\n";
}

}  // namespace

double SvgAxis::at(double value) const noexcept {
    const double fraction = first != last ? (value - first) / (last - first) : 0.5;
    return begin + fraction * (end - begin);
}

double svg_text_width(std::string_view text, double font_size) noexcept {
    // Widths in units of the font size: the mean of lower-case letters and digits, and the full
    // square of East Asian scripts, whose characters take three bytes or more.
    constexpr double kNarrow = 0.62, kWide = 1.0;
    double width = 0.0;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xc0U) != 0x80U) {  // no continuation of a character
            width += byte < 0xe0U ? kNarrow : kWide;
        }
    }
    return width * font_size;
}

SvgPicture::SvgPicture(double width, double height, double font_size, std::string_view title) {
    body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " +
            number(height) + "\" font-family=\"sans-serif\"" +
            attribute("font-size", number(font_size)) + ">\n";
    if (!title.empty()) {
        body_ += "<title>" + escaped(title) + "</title>\n";
    }
    body_ += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
}

void SvgPicture::line(const SvgPoint& from,
                      const SvgPoint& to,
                      std::string_view stroke,
                      double width) {
    polyline(std::array{from, to}, stroke, width);
}

void SvgPicture::polyline(std::span<const SvgPoint> points, std::string_view stroke, double width) {
    body_ += path(path_data(points), stroke, width);
}

void SvgPicture::polylines(std::span<const std::vector<SvgPoint>> lines,
                           std::string_view stroke,
                           double width) {
    std::string data;
    for (const std::vector<SvgPoint>& points : lines) {
        if (points.size() > 1) {
            data += path_data(points);
        }
    }
    if (!data.empty()) {
        body_ += path(data, stroke, width);
    }
}

void SvgPicture::rectangle(const SvgPoint& from,
                           const SvgPoint& to,
                           std::string_view fill,
                           std::string_view title) {
    body_ += "<rect" + attribute("x", number(std::min(from.x, to.x))) +
             attribute("y", number(std::min(from.y, to.y))) +
             attribute("width", number(std::abs(to.x - from.x))) +
             attribute("height", number(std::abs(to.y - from.y))) + attribute("fill", fill);
    body_ += title.empty() ? "/>\n" : "><title>" + escaped(title) + "</title></rect>\n";
}

void SvgPicture::disc(const SvgPoint& centre,
                      double radius,
                      std::string_view fill,
                      std::string_view title) {
    body_ += "<circle" + attribute("cx", number(centre.x)) + attribute("cy", number(centre.y)) +
             attribute("r", number(radius)) + attribute("fill", fill);
    body_ += title.empty() ? "/>\n" : "><title>" + escaped(title) + "</title></circle>\n";
}

void SvgPicture::text(const SvgPoint& at, std::string_view text, const SvgTextStyle& style) {
    body_ += "<text" + attribute("x", number(at.x)) + attribute("y", number(at.y));
    if (style.anchor != "start") {
        body_ += attribute("text-anchor", style.anchor);
    }
    if (style.size > 0.0) {
        body_ += attribute("font-size", number(style.size));
    }
    if (style.fill != "black") {
        body_ += attribute("fill", style.fill);
    }
    if (style.halo) {
        body_ += " stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"";
    }
    body_ += ">" + escaped(text) + "</text>\n";
}

void SvgPicture::axes(const SvgAxis& x, const SvgAxis& y) {
    constexpr double kLabelGap = 6.0, kBaseline = 4.0, kLabelDrop = 18.0;
    polyline(
        std::array{SvgPoint{x.begin, y.end}, SvgPoint{x.begin, y.begin}, SvgPoint{x.end, y.begin}},
        "black");
    for (const double value : y.ticks) {
        text({x.begin - kLabelGap, y.at(value) + kBaseline},
             label(value) + y.unit,
             {.anchor = "end"});
    }
    for (const double value : x.ticks) {
        text({x.at(value), y.begin + kLabelDrop}, label(value) + x.unit, {.anchor = "middle"});
    }
}

}  // namespace earshot::io
