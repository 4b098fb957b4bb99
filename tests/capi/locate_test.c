// SPDX-License-Identifier: MIT
// A listener from arrivals that images tell.
#include "check.h"
#include <math.h>
#include <string.h>

enum { kArrivals = 7 };

static const double kTruth[3] = {3.5, 1.7, 2.5};
/// Of source 0 and listener 0.
static uint32_t pairs[2 * kArrivals];
/// Of the direct sound and, by images, of the six walls, in the order of `surfaces`.
static double times[kArrivals];
static const char* const surfaces[kArrivals] = {
    "direct", "west", "east", "floor", "ceiling", "north", " south "};

static void compute_times(void) {
    const double size[3] = {5.0, 3.0, 4.0}, source[3] = {1.0, 1.2, 1.5}, speed = 343.2;
    for (int i = 0; i < kArrivals; ++i) {
        double image[3] = {source[0], source[1], source[2]};
        if (i > 0) {
            const int axis = (i - 1) / 2;
            image[axis] = (i % 2 == 0 ? 2.0 * size[axis] : 0.0) - image[axis];
        }
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            square += (kTruth[axis] - image[axis]) * (kTruth[axis] - image[axis]);
        }
        times[i] = sqrt(square) / speed;
    }
}

static es_locate_options locate_options(void) {
    es_locate_options options;
    CHECK_OK(es_locate_options_init(&options, sizeof options));
    options.timing_error = 1e-6;
    options.temperature_error = 0.0;
    options.source_error = 0.0;
    return options;
}

/// A listener that is stated 3 cm off, found again.
static void test_a_listener_is_found(void) {
    es_scene scene = make_room(0.36);
    const double stated[3] = {kTruth[0] + 0.03, kTruth[1], kTruth[2] - 0.02};
    CHECK_OK(es_scene_set_position(scene, ES_LISTENERS, 0, stated));
    es_locate_options options = locate_options();
    options.listener_error = INFINITY;
    options.folds = 7;
    es_location location = 0;
    CHECK_OK(es_locate(scene, pairs, times, NULL, kArrivals, &options, &location));
    CHECK(es_kind_of(location) == ES_KIND_LOCATION);
    es_location_info info;
    info.struct_size = sizeof info;
    CHECK_OK(es_location_get_info(location, &info));
    CHECK(info.arrivals == 7 && info.matched == 7 && info.walls == 6 && info.motions == 0);
    CHECK(info.order == 1 && info.converged == 1);
    CHECK(info.median_after < 1e-6 && info.median_before > 1e-5 && info.median_held_out < 1e-5);
    const double *positions = NULL, *errors = NULL, *shares = NULL;
    size_t count = 0;
    CHECK_OK(es_location_positions(location, ES_LISTENERS, &positions, &errors, &shares, &count));
    CHECK(count == 1);
    for (int axis = 0; axis < 3; ++axis) {
        CHECK_NEAR(positions[axis], kTruth[axis], 1.5e-4);
        CHECK(errors[axis] > 0.0 && errors[axis] < 1e-3 && shares[axis] == 1.0);
    }
    const uint32_t* materials = NULL;
    CHECK_OK(es_location_walls(location, &positions, &errors, &materials, &count));
    CHECK(count == 6 && positions[3] == positions[4] && errors[5] == 0.0);
    CHECK_OK(es_location_latencies(location, &positions, NULL, &count));
    CHECK(count == 1 && positions[0] == 0.0);
    CHECK_OK(es_location_arrivals(location, &positions, &count));
    CHECK(count == 7 && fabs(positions[1]) < 1e-6 && positions[3] > 0.9);
    CHECK_OK(es_location_write(location, "positions.json"));
    CHECK_OK(es_release(location));
    // With the names of the walls it is the same.
    CHECK_OK(es_locate(scene, pairs, times, surfaces, kArrivals, &options, &location));
    CHECK_OK(es_location_positions(location, ES_LISTENERS, &positions, NULL, NULL, &count));
    CHECK_NEAR(positions[0], kTruth[0], 1.5e-4);
    CHECK_OK(es_release(location));
    CHECK_OK(es_release(scene));
}

static void test_common_motions(void) {
    es_scene scene = make_room(0.36);
    es_locate_options options = locate_options();
    options.source_error = options.listener_error = 0.01;
    es_location location = 0;
    CHECK_OK(es_locate(scene, pairs, times, surfaces, 1, &options, &location));
    const char* name = NULL;
    double share = 1.0;
    CHECK_OK(es_location_motion(location, 1, &name, &share));
    CHECK_TEXT(name, "translation y");
    CHECK(share < 0.01);
    CHECK_FAILS(ES_ERROR_INDEX, "motion", es_location_motion(location, 6, &name, &share));
    CHECK_OK(es_release(location));
    CHECK_OK(es_release(scene));
}

static void test_wrong_arguments(void) {
    es_scene scene = make_room(0.36);
    es_locate_options options = locate_options();
    es_location location = 0;
    CHECK_FAILS(ES_ERROR_NULL,
                "pairs",
                es_locate(scene, NULL, times, NULL, kArrivals, &options, &location));
    options.listener_error = -1.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "listener_error",
                es_locate(scene, pairs, times, NULL, kArrivals, &options, &location));
    options = locate_options();
    options.folds = kArrivals + 1;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "folds",
                es_locate(scene, pairs, times, NULL, kArrivals, &options, &location));
    options = locate_options();
    const char* unknown[1] = {"no such wall"};
    CHECK_FAILS(ES_ERROR_FAILED,
                "no such wall",
                es_locate(scene, pairs, times, unknown, 1, &options, &location));
    CHECK_FAILS(ES_ERROR_FAILED,
                "no arrivals",
                es_locate(scene, pairs, times, NULL, 0, &options, &location));
    const uint32_t beyond[2] = {0, 5};
    CHECK_FAILS(
        ES_ERROR_INDEX, "pairs", es_locate(scene, beyond, times, NULL, 1, &options, &location));
    CHECK(location == 0);
    CHECK_OK(es_release(scene));
}

/// Whether the library was built with the solver.
static int can_locate(void) {
    es_scene scene = make_room(0.36);
    es_location location = 0;
    const es_status status = es_locate(scene, pairs, times, NULL, kArrivals, NULL, &location);
    const int lacks_solver = status != ES_OK && strstr(es_error_message(), "Ceres") != NULL;
    CHECK_OK(es_release(location));
    CHECK_OK(es_release(scene));
    return !lacks_solver;
}

void test_locations(void) {
    compute_times();
    if (!can_locate()) {
        return;
    }
    test_a_listener_is_found();
    test_common_motions();
    test_wrong_arguments();
}
