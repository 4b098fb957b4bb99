// SPDX-License-Identifier: MIT
#include "earshot/io/map_picture.h"

#include "earshot/base/math.h"
#include "earshot/io/internal/raster.h"
#include "earshot/io/svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace earshot::io {

using geometry::Vec3;
using propagation::MapMetric;
using propagation::MetricMap;

namespace {

constexpr double kPlanSide = 640.0;  // of the longer side of the plan, pixels
constexpr double kLeft = 64.0, kTop = 48.0, kBottom = 56.0, kRight = 150.0;  // margins
constexpr double kBarGap = 24.0, kBarWidth = 22.0;
constexpr double kMinPlanSide = 160.0;  // of the shorter side
constexpr Rgb kBlack = {0, 0, 0}, kWhite = {255, 255, 255}, kUnknown = {214, 214, 214};
constexpr Rgb kWall = {40, 40, 40}, kSource = {200, 30, 40};

std::string name_of(const Rgb& colour) {
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour[0], colour[1], colour[2]);
    return text.data();
}

std::string short_number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value + 0.0);
    return text.data();
}

/// What a drawing is drawn on: SVG, or pixels.
class SvgCanvas {
public:
    SvgCanvas(double width, double height, const std::string& title)
        : picture_(width, height, 13.0, title) {}

    void rectangle(const SvgPoint& from, const SvgPoint& to, const Rgb& fill) {
        picture_.rectangle(from, to, name_of(fill));
    }
    void line(const std::vector<SvgPoint>& points, const Rgb& stroke, double width) {
        picture_.polyline(points, name_of(stroke), width);
    }
    void lines(const std::vector<std::vector<SvgPoint>>& all, const Rgb& stroke, double width) {
        picture_.polylines(all, name_of(stroke), width);
    }
    void disc(const SvgPoint& centre, double radius, const Rgb& fill, const std::string& title) {
        picture_.disc(centre, radius, name_of(fill), title);
    }
    void text(const SvgPoint& at, const std::string& text, const std::string& anchor) {
        picture_.text(at, text, {.anchor = anchor, .halo = true});
    }
    std::string str() const { return picture_.str(); }

private:
    SvgPicture picture_;
};

class PixelCanvas {
public:
    PixelCanvas(double width, double height)
        : raster_(static_cast<std::size_t>(width), static_cast<std::size_t>(height)) {}

    void rectangle(const SvgPoint& from, const SvgPoint& to, const Rgb& fill) {
        raster_.rectangle(from, to, fill);
    }
    void line(const std::vector<SvgPoint>& points, const Rgb& stroke, double width) {
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            raster_.line(points[i], points[i + 1], stroke, width);
        }
    }
    void lines(const std::vector<std::vector<SvgPoint>>& all, const Rgb& stroke, double width) {
        for (const std::vector<SvgPoint>& points : all) {
            line(points, stroke, width);
        }
    }
    void disc(const SvgPoint& centre, double radius, const Rgb& fill, const std::string&) {
        raster_.disc(centre, radius, fill);
    }
    void text(const SvgPoint& at, const std::string& text, const std::string& anchor) {
        raster_.text(at, text, anchor, kBlack);
    }
    const Picture& picture() const { return raster_.picture(); }

private:
    Raster raster_;
};

/// The part of the plane that is drawn, metres.
struct Extent {
    double x0 = std::numeric_limits<double>::infinity(), z0 = x0, x1 = -x0, z1 = -x0;

    void include(double x, double z) {
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        z0 = std::min(z0, z);
        z1 = std::max(z1, z);
    }
    void widen(double by) {
        x0 -= by;
        z0 -= by;
        x1 += by;
        z1 += by;
    }
};

/// The map and a margin, so that walls beside it show.
Extent extent_of(const MetricMap& map) {
    Extent extent;
    if (map.lattice.sheets() > 0) {
        extent.include(map.lattice.x_at(0.0), map.lattice.z_at(0.0));
        extent.include(map.lattice.x_at(map.lattice.columns()),
                       map.lattice.z_at(map.lattice.rows()));
    } else {
        for (const propagation::MapCellPoint& cell : map.cells) {
            extent.include(cell.point.x, cell.point.z);
        }
    }
    constexpr double kShare = 0.06, kMin = 0.4;
    extent.widen(kMin + kShare * std::max(extent.x1 - extent.x0, extent.z1 - extent.z0));
    return extent;
}

/// The part of a segment in the extent; false: there is none (Liang and Barsky 1984).
bool clip(const Extent& extent, std::array<std::array<double, 2>, 2>& segment) {
    double begin = 0.0, end = 1.0;
    const std::array<double, 2> from = segment[0];
    const std::array<double, 2> way = {segment[1][0] - from[0], segment[1][1] - from[1]};
    const std::array<double, 2> low = {extent.x0, extent.z0}, high = {extent.x1, extent.z1};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (way[axis] == 0.0) {
            if (from[axis] < low[axis] || from[axis] > high[axis]) {
                return false;
            }
            continue;
        }
        const double a = (low[axis] - from[axis]) / way[axis];
        const double b = (high[axis] - from[axis]) / way[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    for (std::size_t i = 0; i < 2; ++i) {
        const double at = i == 0 ? begin : end;
        segment[i] = {from[0] + at * way[0], from[1] + at * way[1]};
    }
    return begin < end;
}

/// A round number of metres between ticks, so that there are about six.
double tick_step(double length) {
    constexpr double kTicks = 6.0;
    const double decade = math::pow10(std::floor(math::log10(length / kTicks)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * decade * kTicks >= length) {
            return factor * decade;
        }
    }
    return 10.0 * decade;
}

template <typename Canvas>
class Drawer {
public:
    Drawer(const MapDrawing& drawing, const Extent& extent, double scale, Canvas& canvas)
        : drawing_(drawing),
          map_(drawing.map),
          extent_(extent),
          scale_(scale),
          canvas_(canvas),
          levels_(map_levels(drawing)) {}

    void draw() {
        draw_cells();
        draw_walls();
        draw_contour();
        draw_sources();
        draw_axes();
        draw_scale();
        canvas_.text({kLeft, kTop - 18.0}, drawing_.title, "start");
    }

private:
    SvgPoint at(double x, double z) const {
        return {kLeft + (x - extent_.x0) * scale_, kTop + (z - extent_.z0) * scale_};
    }
    double plan_width() const { return (extent_.x1 - extent_.x0) * scale_; }
    double plan_height() const { return (extent_.z1 - extent_.z0) * scale_; }
    const MapMetric& metric() const { return map_.metrics[drawing_.metric]; }

    Rgb colour_of(const std::optional<double>& value) const {
        if (!value) {
            return kUnknown;
        }
        const auto above = std::upper_bound(levels_.begin(), levels_.end(), *value);
        const auto step = std::clamp<std::ptrdiff_t>(
            above - levels_.begin() - 1, 0, static_cast<std::ptrdiff_t>(levels_.size()) - 2);
        return map_colour(static_cast<std::size_t>(step), levels_.size() - 1);
    }

    void draw_cells() {
        for (std::size_t k = 0; k < map_.cells.size(); ++k) {
            const propagation::MapCellPoint& cell = map_.cells[k];
            const Rgb colour = colour_of(map_.value(k, drawing_.source, drawing_.metric).value);
            if (map_.lattice.sheets() == 0) {
                constexpr double kRadius = 6.0;
                canvas_.disc(at(cell.point.x, cell.point.z), kRadius, colour, "");
                continue;
            }
            canvas_.rectangle(
                at(map_.lattice.x_at(cell.cell.column), map_.lattice.z_at(cell.cell.row)),
                at(map_.lattice.x_at(cell.cell.end_column(map_.lattice)),
                   map_.lattice.z_at(cell.cell.end_row(map_.lattice))),
                colour);
        }
    }

    void draw_walls() {
        std::vector<double> heights;
        for (const propagation::MapCellPoint& cell : map_.cells) {
            heights.push_back(cell.point.y);
        }
        const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
        std::nth_element(heights.begin(), middle, heights.end());
        std::vector<std::vector<SvgPoint>> walls;
        for (auto segment : plan_section(drawing_.mesh, *middle)) {
            if (clip(extent_, segment)) {
                walls.push_back(
                    {at(segment[0][0], segment[0][1]), at(segment[1][0], segment[1][1])});
            }
        }
        constexpr double kWidth = 2.0;
        canvas_.lines(walls, kWall, kWidth);
    }

    void draw_contour() {
        if (!drawing_.limit) {
            return;
        }
        std::vector<std::vector<SvgPoint>> lines;
        for (const auto& contour :
             propagation::evaluate_limit(map_, *drawing_.limit, drawing_.source).contours) {
            std::vector<SvgPoint>& line = lines.emplace_back();
            for (const Vec3& point : contour) {
                line.push_back(at(point.x, point.z));
            }
        }
        constexpr double kHalo = 5.0, kWidth = 2.5;
        canvas_.lines(lines, kWhite, kHalo);
        canvas_.lines(lines, kBlack, kWidth);
    }

    void draw_sources() {
        for (std::size_t i = 0; i < map_.sources.size(); ++i) {
            const Vec3& position = map_.source_positions[i];
            const bool is_inside = position.x >= extent_.x0 && position.x <= extent_.x1 &&
                                   position.z >= extent_.z0 && position.z <= extent_.z1;
            if (!is_inside) {
                continue;
            }
            const SvgPoint centre = at(position.x, position.z);
            constexpr double kOuter = 7.0, kInner = 5.0;
            canvas_.disc(centre, kOuter, kWhite, "");
            canvas_.disc(centre, kInner, i == drawing_.source ? kSource : kWall, map_.sources[i]);
            canvas_.text({centre.x, centre.y - 11.0}, map_.sources[i], "middle");
        }
    }

    void draw_axes() {
        const SvgPoint low = at(extent_.x0, extent_.z0), high = at(extent_.x1, extent_.z1);
        canvas_.line({low, {high.x, low.y}, high, {low.x, high.y}, low}, kBlack, 1.0);
        constexpr double kTick = 5.0, kMinTickLength = 55.0;
        const double step =
            std::max(tick_step(std::max(extent_.x1 - extent_.x0, extent_.z1 - extent_.z0)),
                     tick_step(6.0 * kMinTickLength / scale_));
        for (double x = std::ceil(extent_.x0 / step) * step; x <= extent_.x1; x += step) {
            const double px = at(x, 0.0).x;
            canvas_.line({{px, high.y}, {px, high.y + kTick}}, kBlack, 1.0);
            canvas_.text({px, high.y + 22.0}, short_number(x), "middle");
        }
        for (double z = std::ceil(extent_.z0 / step) * step; z <= extent_.z1; z += step) {
            const double pz = at(0.0, z).y;
            canvas_.line({{low.x - kTick, pz}, {low.x, pz}}, kBlack, 1.0);
            canvas_.text({low.x - 9.0, pz + 5.0}, short_number(z), "end");
        }
        canvas_.text({0.5 * (low.x + high.x), high.y + 44.0}, "x, m", "middle");
        canvas_.text({8.0, high.y + 44.0}, "z, m", "start");
    }

    /// A box per step, labelled at the boundaries, not all of them where they are many.
    void draw_scale() {
        const std::size_t steps = levels_.size() - 1;
        const double left = kLeft + plan_width() + kBarGap;
        const double height = plan_height() / static_cast<double>(steps);
        const auto every = static_cast<std::size_t>(
            std::ceil(20.0 * static_cast<double>(steps + 1) / plan_height()));
        for (std::size_t i = 0; i <= steps; ++i) {
            const double y = kTop + plan_height() - height * static_cast<double>(i);
            if (i < steps) {
                canvas_.rectangle({left, y - height}, {left + kBarWidth, y}, map_colour(i, steps));
            }
            if (i % every == 0 || i == steps) {
                const bool is_crowded =
                    i == steps && i % every != 0 && static_cast<double>(i % every) * height < 16.0;
                if (!is_crowded) {
                    canvas_.text(
                        {left + kBarWidth + 6.0, y + 5.0}, short_number(levels_[i]), "start");
                }
            }
        }
        const std::string unit(metric().unit());
        canvas_.text(
            {left, kTop - 12.0}, metric().name() + (unit.empty() ? "" : ", " + unit), "start");
        if (drawing_.limit) {
            const auto level =
                std::lower_bound(levels_.begin(), levels_.end(), drawing_.limit->value);
            const double y =
                kTop + plan_height() - height * static_cast<double>(level - levels_.begin());
            canvas_.line({{left - 4.0, y}, {left + kBarWidth + 4.0, y}}, kBlack, 2.5);
        }
    }

    const MapDrawing& drawing_;
    const MetricMap& map_;
    Extent extent_;
    double scale_;
    Canvas& canvas_;
    std::vector<double> levels_;
};

struct Layout {
    Extent extent;
    double scale = 1.0, width = 0.0, height = 0.0;
};

Layout layout_of(const MapDrawing& drawing) {
    Layout layout{.extent = extent_of(drawing.map)};
    Extent& extent = layout.extent;
    const double width = extent.x1 - extent.x0, depth = extent.z1 - extent.z0;
    layout.scale = kPlanSide / std::max(width, depth);
    // A row of points gets room for its scale.
    const double lacking = 0.5 * (kMinPlanSide / layout.scale - std::min(width, depth));
    if (lacking > 0.0) {
        (width < depth ? extent.x0 : extent.z0) -= lacking;
        (width < depth ? extent.x1 : extent.z1) += lacking;
    }
    layout.width = kLeft + (extent.x1 - extent.x0) * layout.scale + kRight;
    layout.height = kTop + (extent.z1 - extent.z0) * layout.scale + kBottom;
    return layout;
}

}  // namespace

std::vector<std::array<std::array<double, 2>, 2>> plan_section(const geometry::MeshView& mesh,
                                                               double height) {
    std::vector<std::array<std::array<double, 2>, 2>> segments;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const geometry::Corners corners = geometry::corners(mesh, i);
        std::array<std::array<double, 2>, 2> segment{};
        std::size_t ends = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &a = corners[k], &b = corners[(k + 1) % 3];
            // A corner in the plane counts as above it, so that edges are met 0 or 2 times.
            if ((a.y >= height) != (b.y >= height)) {
                const double share = (height - a.y) / (b.y - a.y);
                segment[ends++] = {a.x + share * (b.x - a.x), a.z + share * (b.z - a.z)};
            }
        }
        if (ends == 2) {
            segments.push_back(segment);
        }
    }
    return segments;
}

std::string map_title(std::string_view scene,
                      const propagation::MetricMap& map,
                      std::size_t source,
                      std::size_t metric) {
    return std::string(scene) + ": " + map.metrics[metric].name() + " of " + map.sources[source];
}

std::string draw_map_svg(const MapDrawing& drawing) {
    const Layout layout = layout_of(drawing);
    SvgCanvas canvas(layout.width, layout.height, drawing.title);
    Drawer<SvgCanvas>(drawing, layout.extent, layout.scale, canvas).draw();
    return canvas.str();
}

Picture draw_map_picture(const MapDrawing& drawing) {
    const Layout layout = layout_of(drawing);
    PixelCanvas canvas(layout.width, layout.height);
    Drawer<PixelCanvas>(drawing, layout.extent, layout.scale, canvas).draw();
    return canvas.picture();
}

}  // namespace earshot::io
