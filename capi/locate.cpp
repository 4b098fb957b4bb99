// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/location_object.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/arrivals.h"
#include "earshot/io/location.h"
#include "earshot/io/whole_file.h"

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

namespace earshot::capi {

namespace {

using propagation::LocatedPoint;
using propagation::LocatedValue;
using propagation::MeasuredArrival;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Those of `earshot calibrate --locate`.
constexpr es_locate_options kDefaults = {.struct_size = sizeof(es_locate_options),
                                         .source_error = 0.01,
                                         .listener_error = 0.01,
                                         .temperature_error = 2.0,
                                         .latency_error = 0.0,
                                         .wall_error = 0.0,
                                         .timing_error = 4e-5,
                                         .match_window = 1e-3,
                                         .order = -1,
                                         .folds = 0,
                                         .seed = 1,
                                         .time = 0.0,
                                         .temperature_c = 20.0,
                                         .humidity_percent = 50.0,
                                         .pressure_kpa = 101.325,
                                         .progress = nullptr,
                                         .progress_data = nullptr,
                                         .threads = 0};

void require_error(double value, const char* argument) {
    if (!(value >= 0.0)) {
        fail_argument(argument, "is not a number from 0 up", "give 0, a number or INFINITY");
    }
}

es_locate_options checked(const es_locate_options* options, std::size_t arrivals) {
    const es_locate_options whole =
        options == nullptr
            ? kDefaults
            : require_struct(*options, kDefaults, sizeof(es_locate_options), "options");
    require_error(whole.source_error, "options->source_error");
    require_error(whole.listener_error, "options->listener_error");
    require_error(whole.temperature_error, "options->temperature_error");
    require_error(whole.latency_error, "options->latency_error");
    require_error(whole.wall_error, "options->wall_error");
    constexpr double kMinSeconds = 1e-9, kMaxSeconds = 1e6;
    require_in(whole.timing_error, kMinSeconds, kMaxSeconds, "options->timing_error");
    require_in(whole.match_window, kMinSeconds, kMaxSeconds, "options->match_window");
    require_in(std::int64_t{whole.order}, -1, 100, "options->order");
    if (whole.folds != 0) {
        require_count(whole.folds, 2, arrivals, "options->folds");
    }
    require_in(whole.time, -kMaxSeconds, kMaxSeconds, "options->time");
    require_threads(whole.threads, "options->threads");
    return whole;
}

propagation::LocateOptions options_of(const es_locate_options& given) {
    propagation::LocateOptions options = {.source_error = given.source_error,
                                          .listener_error = given.listener_error,
                                          .temperature_error = given.temperature_error,
                                          .latency_error = given.latency_error,
                                          .wall_error = given.wall_error,
                                          .timing_error = given.timing_error,
                                          .match_window = given.match_window,
                                          .air = {.temperature_c = given.temperature_c,
                                                  .humidity_percent = given.humidity_percent,
                                                  .pressure_kpa = given.pressure_kpa},
                                          .time = given.time};
    if (given.order >= 0) {
        options.specular_order = given.order;
    }
    return options;
}

std::vector<MeasuredArrival> arrivals_of(const propagation::Scene& scene,
                                         std::span<const std::uint32_t> pairs,
                                         std::span<const double> times,
                                         const char* const* surfaces) {
    std::vector<MeasuredArrival> arrivals;
    for (std::size_t i = 0; i < times.size(); ++i) {
        require_index(pairs[2 * i], scene.sources.size(), "pairs");
        require_index(pairs[2 * i + 1], scene.listeners.size(), "pairs");
        constexpr double kMaxSeconds = 1e6;
        require_in(times[i], 0.0, kMaxSeconds, "times");
        MeasuredArrival& arrival = arrivals.emplace_back(MeasuredArrival{
            .source = pairs[2 * i], .listener = pairs[2 * i + 1], .time = times[i]});
        if (surfaces != nullptr && surfaces[i] != nullptr) {
            arrival.surfaces = io::parse_surfaces(surfaces[i]);
        }
    }
    return arrivals;
}

LocationObject::Points views_of(const std::vector<LocatedPoint>& located) {
    LocationObject::Points points;
    for (const LocatedPoint& point : located) {
        for (const LocatedValue* value : {&point.x, &point.y, &point.z}) {
            points.positions.push_back(value->value);
            points.standard_errors.push_back(value->standard_error);
            points.data_shares.push_back(value->data_share);
        }
    }
    return points;
}

template <typename T>
void give(const T* array, const T** out) {
    if (out != nullptr) {
        *out = array;
    }
}

}  // namespace

LocationObject::LocationObject(propagation::LocateResult located,
                               std::vector<std::optional<double>> held_out_errors,
                               std::string document)
    : result(std::move(located)),
      held_out(std::move(held_out_errors)),
      json(std::move(document)),
      points{views_of(result.sources), views_of(result.listeners)} {
    for (const LocatedValue& latency : result.latencies) {
        latencies.push_back(latency.value);
        latency_errors.push_back(latency.standard_error);
    }
    for (const propagation::LocatedWall& wall : result.walls) {
        walls.insert(
            walls.end(),
            {wall.normal.x, wall.normal.y, wall.normal.z, wall.offset.stated, wall.offset.value});
        wall_errors.push_back(wall.offset.standard_error);
        wall_materials.push_back(wall.material);
    }
    for (std::size_t i = 0; i < result.arrivals.size(); ++i) {
        const propagation::LocatedArrival& arrival = result.arrivals[i];
        arrivals.insert(arrivals.end(),
                        {arrival.is_matched ? arrival.before : kNone,
                         arrival.is_matched ? arrival.after : kNone,
                         held_out.empty() ? kNone : held_out[i].value_or(kNone),
                         arrival.weight});
    }
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_locate_options_init(es_locate_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_locate_options)); });
}

es_status es_locate(es_scene scene,
                    const uint32_t* pairs,
                    const double* times,
                    const char* const* surfaces,
                    size_t count,
                    const es_locate_options* options,
                    es_location* location) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(location, "location");
        const propagation::Scene& contents = object->loaded.scene;
        const es_locate_options given = checked(options, count);
        const auto arrivals = arrivals_of(contents,
                                          require_array(pairs, 2 * count, "pairs"),
                                          require_array(times, count, "times"),
                                          surfaces);
        Executor executor(given.threads);
        CallbackProgress progress(given.progress, given.progress_data);
        const propagation::LocateOptions locate_options = options_of(given);
        propagation::LocateResult result =
            propagation::locate(contents, arrivals, locate_options, executor, &progress);
        std::vector<std::optional<double>> held_out;
        if (given.folds > 0) {
            held_out = propagation::cross_validate_locate(
                contents, arrivals, given.folds, given.seed, locate_options, executor, &progress);
        }
        std::string json = io::encode_location(
            {.scene = contents, .arrivals = arrivals, .result = result, .held_out = held_out});
        *location = publish(std::make_shared<LocationObject>(
            std::move(result), std::move(held_out), std::move(json)));
    });
}

es_status es_location_get_info(es_location location, es_location_info* info) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        const propagation::LocateResult& result = object->result;
        es_location_info told{};
        told.arrivals = result.arrivals.size();
        told.matched = result.matched;
        told.walls = result.walls.size();
        told.motions = result.motions.size();
        told.median_before = result.median_before;
        told.median_after = result.median_after;
        told.median_held_out = propagation::median_absolute(object->held_out).value_or(kNone);
        told.rms_move = result.rms_move;
        told.speed_of_sound = result.speed_of_sound.value;
        told.speed_error = result.speed_of_sound.standard_error;
        told.temperature_c = result.temperature_c;
        told.order = result.specular_order;
        told.converged = result.converged ? 1 : 0;
        give_struct(told, info, sizeof(es_location_info), "info");
    });
}

es_status es_location_positions(es_location location,
                                int32_t item,
                                const double** positions,
                                const double** standard_errors,
                                const double** data_shares,
                                size_t* count) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        if (item != ES_SOURCES && item != ES_LISTENERS) {
            fail_argument("item", "is " + std::to_string(item), "give ES_SOURCES or ES_LISTENERS");
        }
        const LocationObject::Points& points = object->points[item == ES_SOURCES ? 0 : 1];
        require(positions, "positions") = points.positions.data();
        require(count, "count") = points.positions.size() / 3;
        give(points.standard_errors.data(), standard_errors);
        give(points.data_shares.data(), data_shares);
    });
}

es_status es_location_latencies(es_location location,
                                const double** latencies,
                                const double** standard_errors,
                                size_t* count) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        require(latencies, "latencies") = object->latencies.data();
        require(count, "count") = object->latencies.size();
        give(object->latency_errors.data(), standard_errors);
    });
}

es_status es_location_walls(es_location location,
                            const double** planes,
                            const double** standard_errors,
                            const uint32_t** materials,
                            size_t* count) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        require(planes, "planes") = object->walls.data();
        require(count, "count") = object->wall_errors.size();
        give(object->wall_errors.data(), standard_errors);
        give(object->wall_materials.data(), materials);
    });
}

es_status es_location_arrivals(es_location location, const double** errors, size_t* count) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        require(errors, "errors") = object->arrivals.data();
        require(count, "count") = object->result.arrivals.size();
    });
}

es_status es_location_motion(es_location location,
                             size_t motion,
                             const char** name,
                             double* data_share) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        require_index(motion, object->result.motions.size(), "motion");
        const propagation::CommonMotion& told = object->result.motions[motion];
        if (name != nullptr) {
            *name = told.name.c_str();
        }
        if (data_share != nullptr) {
            *data_share = told.data_share;
        }
    });
}

es_status es_location_write(es_location location, const char* file) {
    return call(__func__, [&] {
        const Reading<LocationObject> object(location, "location");
        io::write_whole_file(std::string(require_text(file, "file")), object->json);
    });
}
