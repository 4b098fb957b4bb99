// SPDX-License-Identifier: MIT
#include "earshot/propagation/metric_map.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/base/error.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <string_view>
#include <utility>

namespace earshot::propagation {

using geometry::Vec3;

namespace {

/// Points of one pass of rays: so many that the rays' own cost is small beside that of the points,
/// and so few that their sums (about a megabyte each) fit into memory.
constexpr std::size_t kPointsPerPass = 512;

/// Tells of the rays of all passes as of one stage.
class PassProgress : public Progress {
public:
    PassProgress(Progress* whole, std::string_view stage, std::size_t pass, std::size_t passes)
        : whole_(whole), stage_(stage), pass_(pass), passes_(passes) {}

    void report(std::string_view stage, std::size_t done, std::size_t total) override {
        if (whole_ != nullptr && stage == "late rays") {
            whole_->report(stage_, pass_ * total + done, passes_ * total);
        }
    }
    void finish() {
        if (whole_ != nullptr) {
            whole_->report(stage_, pass_ + 1, passes_);
        }
    }

private:
    Progress* whole_;
    std::string_view stage_;
    std::size_t pass_, passes_;
};

/// Evaluates points by one simulator, whose beam trees are those of all points.
class Evaluation {
public:
    Evaluation(const Scene& scene,
               double time,
               const std::vector<MapMetric>& metrics,
               const MapOptions& options,
               Executor& executor)
        : scene_(scene),
          metrics_(metrics),
          options_(options),
          simulator_(scene_, map_simulation(options.simulation), executor) {
        scene_.listeners.clear();
        simulator_.set_time(time, executor);
    }

    RayScene ray_scene() const { return simulator_.ray_scene(); }
    std::size_t uncertain() const { return uncertain_; }
    std::size_t values_per_point() const { return scene_.sources.size() * metrics_.size(); }

    /// (points, sources, metrics)
    std::vector<MapValue> values_at(std::span<const Vec3> points,
                                    std::string_view stage,
                                    Executor& executor,
                                    Progress* progress) {
        std::vector<MapValue> values(points.size() * values_per_point());
        const std::size_t passes = chunk_count(points.size(), kPointsPerPass);
        for (std::size_t pass = 0; pass < passes; ++pass) {
            const std::size_t first = pass * kPointsPerPass;
            const auto part =
                points.subspan(first, std::min(kPointsPerPass, points.size() - first));
            PassProgress of_pass(progress, stage, pass, passes);
            evaluate(
                part, std::span(values).subspan(first * values_per_point()), executor, of_pass);
            of_pass.finish();
        }
        return values;
    }

private:
    void evaluate(std::span<const Vec3> points,
                  std::span<MapValue> values,
                  Executor& executor,
                  Progress& progress) {
        scene_.listeners.clear();
        for (std::size_t k = 0; k < points.size(); ++k) {
            scene_.listeners.push_back(
                {.name = "point " + std::to_string(k), .position = points[k]});
        }
        std::vector<std::uint8_t> is_uncertain(points.size(), 0);
        std::mutex mutex;
        const auto read = [&](PairResult&& pair) {
            const audio::RoomMetrics found = audio::energy_metrics(
                options_.simulation.bands,
                energy_arrivals_of(pair),
                pair.late,
                {.replicates = &pair.late_replicates, .speech = options_.speech});
            MapValue* out = values.data() +
                            (pair.listener * scene_.sources.size() + pair.source) * metrics_.size();
            for (const MapMetric& metric : metrics_) {
                *out++ = metric.read(found);
            }
            if (!pair.late_errors.reached) {
                const std::lock_guard lock(mutex);
                is_uncertain[pair.listener] = 1;
            }
        };
        simulator_.for_each_pair(read, executor, &progress);
        uncertain_ += static_cast<std::size_t>(
            std::count(is_uncertain.begin(), is_uncertain.end(), std::uint8_t{1}));
    }

    Scene scene_;  // whose listeners are the points of a pass
    const std::vector<MapMetric>& metrics_;
    const MapOptions& options_;
    Simulator simulator_;
    std::size_t uncertain_ = 0;
};

void check(const Scene& scene, const std::vector<MapMetric>& metrics, const MapOptions& options) {
    if (scene.sources.empty()) {
        throw Error(scene.name, "the scene has no source", "give it one");
    }
    if (metrics.empty()) {
        throw Error("map", "no metric is asked for", "name one, sti or t30");
    }
    if (!(options.clearance >= 0.0 && std::isfinite(options.clearance))) {
        throw Error("clearance of the map", "must be 0 or more");
    }
    if (!(options.step > 0.0 && options.coarse_step >= options.step &&
          std::isfinite(options.coarse_step))) {
        throw Error("steps of the map",
                    "must be positive, and the coarse one not below the fine one");
    }
}

/// The largest power of two with which the step does not exceed the coarse one.
std::uint32_t coarse_size(const MapOptions& options) {
    // 1 is 4 times 0.25, and 0.3 is 3 times 0.1, for people.
    constexpr double kRounding = 1e-9;
    std::uint32_t size = 1;
    while (2.0 * size * options.step <= options.coarse_step * (1.0 + kRounding) &&
           size < (1U << 16U)) {
        size *= 2;
    }
    return size;
}

void require_points(const Scene& scene, const MetricMap& map) {
    if (map.points_evaluated == 0) {
        throw Error(scene.name,
                    "no point of the map is in the air: " + std::to_string(map.excluded.outside) +
                        " are outside of the room, " + std::to_string(map.excluded.in_solid) +
                        " in solids, " + std::to_string(map.excluded.near_surface) +
                        " too near to surfaces",
                    "check area and height");
    }
}

std::vector<Vec3> points_of(std::span<const MapCellPoint> cells) {
    std::vector<Vec3> points;
    for (const MapCellPoint& cell : cells) {
        points.push_back(cell.point);
    }
    return points;
}

/// Puts the cells into the order of the lattice.
void sort_cells(MetricMap& map, std::size_t values_per_cell) {
    std::vector<std::size_t> order(map.cells.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return map.cells[a].cell < map.cells[b].cell;
    });
    std::vector<MapCellPoint> cells;
    std::vector<MapValue> values;
    for (const std::size_t k : order) {
        cells.push_back(map.cells[k]);
        const auto from = map.values.begin() + static_cast<std::ptrdiff_t>(k * values_per_cell);
        values.insert(values.end(), from, from + static_cast<std::ptrdiff_t>(values_per_cell));
    }
    map.cells = std::move(cells);
    map.values = std::move(values);
}

/// Replaces cells of which some value changes to a neighbour by their quarters, until none is left.
void refine(MetricMap& map,
            const AirTest& air,
            Evaluation& evaluation,
            Executor& executor,
            Progress* progress) {
    const std::size_t per_cell = evaluation.values_per_point();
    for (;;) {
        const std::vector<std::size_t> halved =
            cells_to_halve(map.lattice, map.cells, map.values, map.metrics);
        if (halved.empty()) {
            return;
        }
        std::vector<MapCellPoint> added;
        std::vector<std::uint8_t> is_halved(map.cells.size(), 0);
        for (const std::size_t k : halved) {
            is_halved[k] = 1;
            const auto quarters = quarters_of(map.cells[k].cell, map.lattice, air);
            added.insert(added.end(), quarters.begin(), quarters.end());
        }
        const std::vector<MapValue> values =
            evaluation.values_at(points_of(added), "refining", executor, progress);
        map.points_evaluated += added.size();
        std::vector<MapCellPoint> cells;
        std::vector<MapValue> kept;
        for (std::size_t k = 0; k < map.cells.size(); ++k) {
            if (is_halved[k] == 0) {
                cells.push_back(map.cells[k]);
                const auto from = map.values.begin() + static_cast<std::ptrdiff_t>(k * per_cell);
                kept.insert(kept.end(), from, from + static_cast<std::ptrdiff_t>(per_cell));
            }
        }
        cells.insert(cells.end(), added.begin(), added.end());
        kept.insert(kept.end(), values.begin(), values.end());
        map.cells = std::move(cells);
        map.values = std::move(kept);
    }
}

/// Given points: those without a value keep their places.
void map_points(const MapPointList& points,
                const AirTest& air,
                Evaluation& evaluation,
                MetricMap& map,
                Executor& executor,
                Progress* progress) {
    map.exclusions.resize(points.size());
    executor.for_each(points.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            map.exclusions[k] = air.exclusion_at(points[k]);
        }
    });
    std::vector<Vec3> in_air;
    for (std::size_t k = 0; k < points.size(); ++k) {
        map.cells.push_back({.cell = {.size = 0}, .point = points[k]});
        map.excluded.add(map.exclusions[k]);
        if (map.exclusions[k] == PointExclusion::none) {
            in_air.push_back(points[k]);
        }
    }
    map.points_evaluated = in_air.size();
    const std::vector<MapValue> values = evaluation.values_at(in_air, "map", executor, progress);
    const std::size_t per_point = evaluation.values_per_point();
    map.values.resize(points.size() * per_point);
    auto from = values.begin();
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (map.exclusions[k] == PointExclusion::none) {
            std::copy_n(
                from, per_point, map.values.begin() + static_cast<std::ptrdiff_t>(k * per_point));
            from += static_cast<std::ptrdiff_t>(per_point);
        }
    }
}

}  // namespace

Options map_simulation(Options options) {
    options.report_paths = false;
    options.keep_traces = true;
    options.late_directions = false;
    // In the classroom this leaves the standard errors as they are, and takes half of the time.
    constexpr double kRainRadius = 1.5;
    options.rain_radius = kRainRadius;
    options.weight_window = true;
    return options;
}

double MetricMap::area(std::size_t cell) const noexcept {
    const MapCell& square = cells[cell].cell;
    if (square.size == 0) {
        return 1.0;
    }
    return lattice.cell_width() * (square.end_column(lattice) - square.column) *
           lattice.cell_depth() * (square.end_row(lattice) - square.row);
}

MetricMap compute_metric_map(const Scene& scene,
                             double time,
                             const MapArea& area,
                             const std::vector<MapMetric>& metrics,
                             const MapOptions& options,
                             Executor& executor,
                             Progress* progress) {
    check(scene, metrics, options);
    MetricMap map{.metrics = metrics, .time = time};
    for (const Emitter& source : scene.sources) {
        map.sources.push_back(source.name);
        map.source_positions.push_back(scene.position_at(source, time));
    }
    Evaluation evaluation(scene, time, map.metrics, options, executor);
    const RayScene rays = evaluation.ray_scene();
    const AirTest air(scene, time, rays.bvh, options.clearance);
    if (const auto* points = std::get_if<MapPointList>(&area)) {
        map_points(*points, air, evaluation, map, executor, progress);
        require_points(scene, map);
        map.points_uncertain = evaluation.uncertain();
        return map;
    }
    const auto* rectangle = std::get_if<MapRectangle>(&area);
    map.lattice =
        rectangle != nullptr
            ? MapLattice(*rectangle, options.step, air, executor)
            : MapLattice(scene, time, std::get<MapSurface>(area), options.step, air, executor);
    map.excluded = map.lattice.excluded();
    map.cells = coarsest_cells(map.lattice, coarse_size(options), air);
    map.points_evaluated = map.cells.size();
    require_points(scene, map);
    map.values = evaluation.values_at(points_of(map.cells), "map", executor, progress);
    refine(map, air, evaluation, executor, progress);
    sort_cells(map, evaluation.values_per_point());
    map.exclusions.assign(map.cells.size(), PointExclusion::none);
    map.points_uncertain = evaluation.uncertain();
    return map;
}

}  // namespace earshot::propagation
