// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/speech.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/propagation/map_metric.h"
#include "earshot/propagation/map_points.h"
#include "earshot/propagation/map_refinement.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

struct MapOptions {
    /// Of the paths and rays to each point. Paths are not kept (Options::report_paths), beam trees
    /// are, diffuse rain falls on far points by chance (Options::rain_radius), and rays have a
    /// weight window: see map_simulation().
    Options simulation{};
    std::optional<audio::SpeechConditions> speech{};  ///< for STI
    double step = 0.25;  ///< edge of the smallest cells, metres, at most
    /// Edge of the first cells, metres, at most: `step` times a power of two. They are halved where
    /// values change, see cells_to_halve(). With `step` itself all cells are as small.
    double coarse_step = 1.0;
    double clearance = 0.1;  ///< of points to surfaces, metres, at least
};

/// Options of a simulation as maps need them.
Options map_simulation(Options options = {});

/// Metrics over an area, at a point in the middle of each of its cells, or at given points.
struct MetricMap {
    std::vector<MapMetric> metrics{};
    std::vector<std::string> sources{};              ///< names
    std::vector<geometry::Vec3> source_positions{};  ///< likewise
    double time = 0.0;                               ///< seconds, of the scene's animation
    MapLattice lattice{};                            ///< without cells for given points
    /// In the order of their sheets, rows and columns; given points in their order, each with a
    /// MapCell of size 0.
    std::vector<MapCellPoint> cells{};
    std::vector<PointExclusion> exclusions{};  ///< per cell; `none` but for given points
    std::vector<MapValue> values{};            ///< (cells, sources, metrics), row-major
    ExclusionCounts excluded{};                ///< cells of the lattice, or given points
    std::size_t points_evaluated = 0;          ///< those of cells that were halved included
    std::size_t points_uncertain = 0;          ///< whose rays did not reach the error asked for

    const MapValue& value(std::size_t cell, std::size_t source, std::size_t metric) const noexcept {
        return values[(cell * sources.size() + source) * metrics.size() + metric];
    }
    /// Square metres of a cell seen from above; 1 for given points.
    double area(std::size_t cell) const noexcept;
};

/// The metrics of `audio::energy_metrics()` at every point: what `earshot ir` tells of a listener
/// there, within their standard errors. A point's values depend on no other point, and the map
/// neither on the executor nor on the order of points. Throws Error if there is no source, no
/// metric, no point in the air, or an option is out of range. Reports the stage "map", and for
/// cells that were halved "refining".
MetricMap compute_metric_map(const Scene& scene,
                             double time,
                             const MapArea& area,
                             const std::vector<MapMetric>& metrics,
                             const MapOptions& options = {},
                             Executor& executor = Executor::serial(),
                             Progress* progress = nullptr);

}  // namespace earshot::propagation
