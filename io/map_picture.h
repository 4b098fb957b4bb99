// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/io/png.h"
#include "earshot/propagation/map_limit.h"
#include "earshot/propagation/metric_map.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// One metric of one source, to be drawn as a plan: x to the right, z downwards.
struct MapDrawing {
    const propagation::MetricMap& map;
    std::size_t source = 0;
    std::size_t metric = 0;
    geometry::MeshView mesh{};  ///< whose section at the map's height is drawn as walls
    std::optional<propagation::MapLimit> limit{};  ///< whose contour is drawn
    std::string title{};
};

/// The boundaries of the colours of a map: steps of one just-noticeable difference about 0 or, of
/// relative differences, about 1; about the limit, where there is one; of several where there would
/// be more than 200. Ascending, at least two.
std::vector<double> map_levels(const MapDrawing& drawing);

/// The colour of a step of several: from dark blue over grey to yellow, so that lightness alone
/// orders them, for colour-blind eyes and grey prints. Precondition: step < steps.
std::array<std::uint8_t, 3> map_colour(std::size_t step, std::size_t steps) noexcept;

/// The segments in which triangles meet the plane y = `height`, in x and z.
std::vector<std::array<std::array<double, 2>, 2>> plan_section(const geometry::MeshView& mesh,
                                                               double height);

/// "SCENE: METRIC of SOURCE".
std::string map_title(std::string_view scene,
                      const propagation::MetricMap& map,
                      std::size_t source,
                      std::size_t metric);

std::string draw_map_svg(const MapDrawing& drawing);
Picture draw_map_picture(const MapDrawing& drawing);

}  // namespace earshot::io
