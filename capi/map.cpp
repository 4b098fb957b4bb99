// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/map_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/map_table.h"
#include "earshot/io/whole_file.h"

#include <limits>
#include <memory>
#include <string_view>

namespace earshot::capi {

namespace {

using propagation::MapLimitResult;
using propagation::MapMetric;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kDefaultMetrics = "sti,t30,c80";

// Those of `earshot map`.
constexpr es_map_options kDefaults = {.struct_size = sizeof(es_map_options),
                                      .area = ES_MAP_RECTANGLE,
                                      .material = 0,
                                      .rectangle = {0.0, 0.0, 0.0, 0.0},
                                      .height = 1.2,
                                      .step = 0.25,
                                      .coarse_step = 0.0,
                                      .clearance = 0.1,
                                      .points = nullptr,
                                      .point_count = 0,
                                      .metrics = nullptr};

es_map_options checked(const es_map_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_map_options whole =
        require_struct(*options, kDefaults, sizeof(es_map_options), "options");
    constexpr double kMaxCoordinate = 1e9;
    require_in(std::int64_t{whole.area}, ES_MAP_RECTANGLE, ES_MAP_POINTS, "options->area");
    for (const double coordinate : whole.rectangle) {
        require_in(coordinate, -kMaxCoordinate, kMaxCoordinate, "options->rectangle");
    }
    require_in(whole.height, -kMaxCoordinate, kMaxCoordinate, "options->height");
    require_in(whole.step, 1e-3, kMaxCoordinate, "options->step");
    if (whole.coarse_step != 0.0) {
        require_in(whole.coarse_step, whole.step, kMaxCoordinate, "options->coarse_step");
    }
    require_in(whole.clearance, 0.0, kMaxCoordinate, "options->clearance");
    return whole;
}

propagation::MapArea area_of(const es_map_options& options, const propagation::Scene& scene) {
    switch (options.area) {
        case ES_MAP_SURFACE:
            require_index(options.material, scene.materials.size(), "options->material");
            return propagation::MapSurface{.material = options.material, .height = options.height};
        case ES_MAP_POINTS: {
            const auto points =
                require_points(options.points, options.point_count, "options->points");
            return propagation::MapPointList(points.begin(), points.end());
        }
        default:
            return propagation::MapRectangle{.x0 = options.rectangle[0],
                                             .z0 = options.rectangle[1],
                                             .x1 = options.rectangle[2],
                                             .z1 = options.rectangle[3],
                                             .height = options.height};
    }
}

std::vector<MapMetric> metrics_of(const es_map_options& options, const audio::Bands& bands) {
    std::string_view rest = text_or(options.metrics, kDefaultMetrics, "options->metrics");
    std::vector<MapMetric> metrics;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
        comma = rest.find(',');
        metrics.emplace_back(rest.substr(0, comma), bands);
        rest = comma == std::string_view::npos ? rest : rest.substr(comma + 1);
    }
    return metrics;
}

constexpr double kRaysError = 0.04;  // of T30, without options

es_map_limit limit_of(const propagation::MetricMap& map, const MapLimitResult& result) {
    es_map_limit limit{};
    limit.share = result.share;
    limit.uncertain_share = result.uncertain_share;
    limit.unknown_share = result.unknown_share;
    limit.worst = result.worst.value_or(kNone);
    for (int axis = 0; axis < 3; ++axis) {
        limit.worst_point[axis] = result.worst ? map.cells[result.worst_cell].point[axis] : kNone;
    }
    return limit;
}

void require_limit(const MapObject& object,
                   std::size_t source,
                   std::size_t metric,
                   double value,
                   const char* argument) {
    require_index(source, object.map.sources.size(), "source");
    require_index(metric, object.map.metrics.size(), "metric");
    require_map_limit(value, argument);
}

es_map_info info_of(const propagation::MetricMap& map) {
    es_map_info info{};
    info.points = map.cells.size();
    info.sources = map.sources.size();
    info.metrics = map.metrics.size();
    info.points_evaluated = map.points_evaluated;
    info.points_uncertain = map.points_uncertain;
    info.outside = map.excluded.outside;
    info.in_solid = map.excluded.in_solid;
    info.near_surface = map.excluded.near_surface;
    info.time = map.time;
    return info;
}

}  // namespace

void require_map_limit(double value, const char* argument) {
    constexpr double kMaxLimit = 1e9;
    require_in(value, -kMaxLimit, kMaxLimit, argument);
}

MapObject::MapObject(std::string scene_name, propagation::MetricMap metric_map)
    : scene(std::move(scene_name)), map(std::move(metric_map)) {
    for (const propagation::MapValue& value : map.values) {
        values.push_back(value.value.value_or(kNone));
        standard_errors.push_back(value.standard_error.value_or(kNone));
    }
    const propagation::MapLattice& lattice = map.lattice;
    for (const auto& [cell, point] : map.cells) {
        points.insert(points.end(), {point.x, point.y, point.z});
        if (cell.size == 0) {
            cells.insert(cells.end(), 4, kNone);
        } else {
            cells.insert(cells.end(),
                         {lattice.x_at(cell.column),
                          lattice.z_at(cell.row),
                          lattice.x_at(cell.end_column(lattice)),
                          lattice.z_at(cell.end_row(lattice))});
        }
    }
    for (const MapMetric& metric : map.metrics) {
        units.emplace_back(metric.unit());
    }
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_map_options_init(es_map_options* options, size_t size) {
    return call(__func__, [&] { init_struct(kDefaults, options, size, sizeof(es_map_options)); });
}

es_status es_map_create(es_scene scene,
                        const es_simulation_options* simulation,
                        const es_map_options* options,
                        es_metric_map* map) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(map, "map");
        const propagation::Scene& contents = object->loaded.scene;
        const es_simulation_options given = checked_options_or(simulation, kRaysError);
        const es_map_options whole = checked(options);
        propagation::MapOptions map_options{
            .simulation = simulator_options(given),
            .speech = speech_conditions(given),
            .step = whole.step,
            .coarse_step = whole.coarse_step > 0.0 ? whole.coarse_step : 4.0 * whole.step,
            .clearance = whole.clearance};
        map_options.simulation.late_length = 0.0;
        Executor executor(given.threads);
        CallbackProgress progress(given.progress, given.progress_data);
        *map = publish(std::make_shared<MapObject>(
            contents.name,
            propagation::compute_metric_map(contents,
                                            given.time,
                                            area_of(whole, contents),
                                            metrics_of(whole, map_options.simulation.bands),
                                            map_options,
                                            executor,
                                            &progress)));
    });
}

es_status es_map_get_info(es_metric_map map, es_map_info* info) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        give_struct(info_of(object->map), info, sizeof(es_map_info), "info");
    });
}

es_status es_map_values(es_metric_map map,
                        const double** values,
                        const double** standard_errors,
                        size_t shape[3]) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require(values, "values");
        require(shape, "shape");
        *values = object->values.data();
        if (standard_errors != nullptr) {
            *standard_errors = object->standard_errors.data();
        }
        shape[0] = object->map.cells.size();
        shape[1] = object->map.sources.size();
        shape[2] = object->map.metrics.size();
    });
}

es_status es_map_points(es_metric_map map, const double** points, size_t* count) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require(points, "points");
        require(count, "count") = object->map.cells.size();
        *points = object->points.data();
    });
}

es_status es_map_cells(es_metric_map map, const double** cells, size_t* count) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require(cells, "cells");
        require(count, "count") = object->map.cells.size();
        *cells = object->cells.data();
    });
}

es_status es_map_metric(es_metric_map map,
                        size_t metric,
                        const char** name,
                        const char** unit,
                        double* just_noticeable_difference,
                        int32_t* relative) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require_index(metric, object->map.metrics.size(), "metric");
        const MapMetric& of_map = object->map.metrics[metric];
        const auto give = [](const auto& value, auto* out) {
            if (out != nullptr) {
                *out = value;
            }
        };
        give(of_map.name().c_str(), name);
        give(object->units[metric].c_str(), unit);
        give(of_map.step(), just_noticeable_difference);
        give(of_map.is_relative() ? 1 : 0, relative);
    });
}

es_status es_map_evaluate_limit(es_metric_map map,
                                size_t source,
                                size_t metric,
                                double value,
                                int32_t is_minimum,
                                es_map_limit* result) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require_limit(*object, source, metric, value, "value");
        require_flag(is_minimum, "is_minimum");
        require(result, "result");
        const MapLimitResult found = propagation::evaluate_limit(
            object->map, {.metric = metric, .value = value, .is_minimum = is_minimum != 0}, source);
        give_struct(limit_of(object->map, found), result, sizeof(es_map_limit), "result");
    });
}

es_status es_map_contour(es_metric_map map,
                         size_t source,
                         size_t metric,
                         double level,
                         double* points,
                         uint32_t* lines,
                         size_t capacity,
                         size_t* count) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        require_limit(*object, source, metric, level, "level");
        const auto points_out = require_array(points, 3 * capacity, "points");
        const auto lines_out = require_array(lines, capacity, "lines");
        require(count, "count");
        std::size_t written = 0;
        std::uint32_t line = 0;
        for (const auto& contour :
             propagation::evaluate_limit(object->map, {.metric = metric, .value = level}, source)
                 .contours) {
            for (const geometry::Vec3& point : contour) {
                for (int axis = 0; written < capacity && axis < 3; ++axis) {
                    points_out[3 * written + static_cast<std::size_t>(axis)] = point[axis];
                }
                if (written < capacity) {
                    lines_out[written] = line;
                }
                ++written;
            }
            ++line;
        }
        *count = written;
    });
}

es_status es_map_write(es_metric_map map, const char* file) {
    return call(__func__, [&] {
        const Reading<MapObject> object(map, "map");
        const std::string path(require_text(file, "file"));
        if (path.ends_with(".csv")) {
            io::write_whole_file(path, io::encode_map_csv(object->map));
        } else if (path.ends_with(".json")) {
            io::write_whole_file(path, io::encode_map_json(object->scene, object->map, {}));
        } else {
            fail_argument("file", "ends in neither .csv nor .json", "name such a file");
        }
    });
}
