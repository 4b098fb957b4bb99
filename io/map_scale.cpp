// SPDX-License-Identifier: MIT
// The scale of a map's colours.
#include "earshot/base/math.h"
#include "earshot/io/internal/raster.h"
#include "earshot/io/map_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::io {

using propagation::MapMetric;
using propagation::MetricMap;

std::vector<double> map_levels(const MapDrawing& drawing) {
    const MetricMap& map = drawing.map;
    const MapMetric& metric = map.metrics[drawing.metric];
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < map.cells.size(); ++k) {
        if (const auto& value = map.value(k, drawing.source, drawing.metric).value) {
            low = std::min(low, *value);
            high = std::max(high, *value);
        }
    }
    if (drawing.limit) {
        low = std::min(low, drawing.limit->value);
        high = std::max(high, drawing.limit->value);
    }
    const bool is_relative = metric.is_relative() && low > 0.0;
    const double origin = drawing.limit ? drawing.limit->value : is_relative ? 1.0 : 0.0;
    if (!(low <= high)) {
        low = high = origin;
    }
    // Steps of factors (1 + share), or of differences, from the origin.
    const double factor = 1.0 + metric.step();
    const auto steps_to = [&](double value) {
        return is_relative ? math::log(value / origin) / math::log(factor)
                           : (value - origin) / metric.step();
    };
    const auto level_at = [&](double steps) {
        return is_relative ? origin * math::exp(steps * math::log(factor))
                           : origin + steps * metric.step();
    };
    constexpr double kRounding = 1e-9;
    const double first = std::floor(steps_to(low) + kRounding);
    const double last = std::max(first + 1.0, std::ceil(steps_to(high) - kRounding));
    // Where a limit is far from all values, a colour takes in several steps.
    constexpr double kMaxColours = 200.0;
    const double stride = std::max(1.0, std::ceil((last - first) / kMaxColours));
    double step = std::floor(first / stride) * stride;
    std::vector<double> levels = {level_at(step)};
    while (step < last) {
        step += stride;
        levels.push_back(level_at(step));
    }
    return levels;
}

Rgb map_colour(std::size_t step, std::size_t steps) noexcept {
    constexpr std::array<std::array<double, 3>, 3> kAnchors = {
        {{10, 36, 92}, {124, 128, 130}, {254, 232, 88}}};
    const double at =
        steps > 1 ? 2.0 * static_cast<double>(step) / static_cast<double>(steps - 1) : 1.0;
    const std::size_t first = at < 1.0 ? 0 : 1;
    Rgb colour{};
    for (std::size_t i = 0; i < colour.size(); ++i) {
        const double share = at - static_cast<double>(first);
        colour[i] = static_cast<std::uint8_t>(std::lround(
            kAnchors[first][i] + share * (kAnchors[first + 1][i] - kAnchors[first][i])));
    }
    return colour;
}

}  // namespace earshot::io
