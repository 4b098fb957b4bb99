// SPDX-License-Identifier: MIT
// Calls that locate sources and listeners.
#include "capi/fuzz_caller.h"
#include <limits>
#include <vector>

namespace earshot::capi_fuzz {
namespace {

/// Reads all numbers of an array, so that sanitizers see them.
void read_all(es_status status, const double* values, std::size_t count) {
    keep_reading(status == ES_OK ? sum(values, count) : 0.0);
}

es_status make_location(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_locate_options given;
    es_locate_options_init(&given, sizeof given);
    for (double* error : {&given.source_error,
                          &given.listener_error,
                          &given.temperature_error,
                          &given.latency_error,
                          &given.wall_error}) {
        *error = c.chance(0.1) ? std::numeric_limits<double>::infinity()
                               : c.number(0.0, 1e9, {0.0, 0.1});
    }
    given.timing_error = c.number(1e-9, 1e6, {1e-6, 1e-3});
    given.match_window = c.number(1e-9, 1e6, {1e-4, 1e-1});
    given.order = c.below(3) - 1;
    given.folds = c.chance(0.7) ? 0 : static_cast<std::uint32_t>(c.below(4));
    given.threads = c.threads();
    const std::size_t count = c.count(12);
    const std::uint32_t* pairs = c.indices(2 * count, 2);
    const double* times = c.values(count, 0.0, 0.05);
    std::vector<const char*> surfaces;
    for (std::size_t i = 0; i < count; ++i) {
        surfaces.push_back(c.text({"direct", "", "floor", "east>west", ">", "no wall"}, true));
    }
    // Whether these fail is not told by each alone: the scene may have no pair, names no surface.
    c.wrong = false;
    es_location location = 0;
    const char* const* names = c.chance(0.3) ? nullptr : surfaces.data();
    const es_status status = es_locate(scene, pairs, times, names, count, &given, c.out(location));
    if (status == ES_OK) {
        c.keep(location);
    }
    return status;
}

es_status use_location(Caller& c) {
    const es_location location = c.handle(ES_KIND_LOCATION);
    const double *values = nullptr, *errors = nullptr, *shares = nullptr;
    const std::uint32_t* materials = nullptr;
    std::size_t count = 0;
    switch (c.below(5)) {
        case 0: {
            const es_status status = es_location_positions(
                location, c.choice(2), c.out(values), &errors, &shares, &count);
            for (const double* array : {values, errors, shares}) {
                read_all(status, array, 3 * count);
            }
            return status;
        }
        case 1: {
            const es_status status =
                es_location_walls(location, c.out(values), &errors, &materials, &count);
            read_all(status, values, 5 * count);
            read_all(status, errors, count);
            return status;
        }
        case 2: {
            const es_status status = es_location_arrivals(location, c.out(values), &count);
            read_all(status, values, 4 * count);
            return status;
        }
        case 3: {
            es_location_info info{};
            info.struct_size = sizeof info;
            static_cast<void>(es_location_get_info(location, &info));
            const char* name = nullptr;
            double share = 0.0;
            return es_location_motion(location, c.index(info.motions), &name, &share);
        }
        default:
            return es_location_latencies(location, c.out(values), &errors, &count);
    }
}

}  // namespace

const std::vector<WeightedCall>& location_calls() {
    static const std::vector<WeightedCall> kCalls{{"make_location", make_location, 4},
                                                  {"use_location", use_location, 8}};
    return kCalls;
}

}  // namespace earshot::capi_fuzz
