// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/metric_map.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A limit that values should keep.
struct MapLimit {
    std::size_t metric = 0;  ///< index into MetricMap::metrics
    double value = 0.0;      ///< in the metric's unit
    bool is_minimum = true;  ///< values should be at least the limit; else at most
};

/// How much of a map meets a limit, for one source.
struct MapLimitResult {
    double share = 0.0;  ///< of the area (of given points: of their number), 0 ... 1
    /// The share whose value is nearer to the limit than two of its standard errors.
    double uncertain_share = 0.0;
    double unknown_share = 0.0;  ///< without a value; counts as not meeting the limit
    /// The worst value and its cell; nothing if no cell has a value.
    std::optional<double> worst{};
    std::size_t worst_cell = 0;
    /// Lines on the map where the value is the limit, each from end to end; a closed one ends where
    /// it begins.
    std::vector<std::vector<geometry::Vec3>> contours{};
};

/// Shares are those of the smallest cells, whose values are interpolated between the cells' points.
/// Precondition: the limit's metric and the source are those of the map.
MapLimitResult evaluate_limit(const MetricMap& map, const MapLimit& limit, std::size_t source);

/// A value for each smallest cell of the map (sheets, rows, columns), as cell_numbers(): between
/// the points of the cells about it, bilinear where these are equally large; NaN where there is
/// none.
std::vector<double> interpolated_values(const MetricMap& map,
                                        std::size_t source,
                                        std::size_t metric);

/// Lines where values given in the middles of a lattice's cells are `level`, as
/// MapLimitResult::contours: marching squares (Lorensen and Cline 1987, in the plane) with linear
/// interpolation. Squares with a corner without a value (NaN) have no line.
std::vector<std::vector<geometry::Vec3>> contour_lines(const MapLattice& lattice,
                                                       std::span<const double> values,
                                                       double level);

}  // namespace earshot::propagation
