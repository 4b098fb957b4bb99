// SPDX-License-Identifier: MIT
// Maps against simulations with listeners at the same points.
#include "check.h"
#include <math.h>
#include <string.h>

static es_map_options map_options(void) {
    es_map_options options;
    CHECK_OK(es_map_options_init(&options, sizeof options));
    return options;
}

/// Without rays the values are those of listeners, to the last bit.
static void test_values_are_those_of_listeners(void) {
    const double points[] = {3.5, 1.7, 2.5, 2.0, 1.2, 3.0};
    es_scene scene = make_room(0.36);
    es_simulation_options simulation = early_options(12);
    es_map_options options = map_options();
    options.area = ES_MAP_POINTS;
    options.points = points;
    options.point_count = 2;
    options.metrics = "c80,g:1000";
    es_metric_map map = 0;
    CHECK_OK(es_map_create(scene, &simulation, &options, &map));
    CHECK(es_kind_of(map) == ES_KIND_METRIC_MAP);

    CHECK_OK(es_scene_add(scene, ES_LISTENERS, points + 3, NULL, 1, NULL));
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &simulation, &result));
    const double *mapped = NULL, *of_listeners = NULL;
    size_t shape[3], result_shape[3];
    CHECK_OK(es_map_values(map, &mapped, NULL, shape));
    CHECK(shape[0] == 2 && shape[1] == 1 && shape[2] == 2);
    CHECK_OK(es_result_metric(
        result, ES_METRIC_C80, ES_EXPECTED, ES_SINGLE_NUMBER, &of_listeners, NULL, result_shape));
    for (size_t i = 0; i < 2; ++i) {
        CHECK_NEAR(mapped[2 * i], of_listeners[i], 0.0);
    }
    CHECK_OK(es_result_metric(
        result, ES_METRIC_G, ES_EXPECTED, ES_PER_BAND, &of_listeners, NULL, result_shape));
    for (size_t i = 0; i < 2; ++i) {
        CHECK_NEAR(mapped[2 * i + 1], of_listeners[10 * i + 5], 0.0);
    }
    const double* cells = NULL;
    size_t count = 0;
    CHECK_OK(es_map_cells(map, &cells, &count));
    CHECK(count == 2 && isnan(cells[0]));
    CHECK_OK(es_release(map));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}

static void test_areas_and_limits(void) {
    es_scene scene = make_room(0.36);
    es_simulation_options simulation = early_options(12);
    es_map_options options = map_options();
    const double rectangle[4] = {0.0, 0.0, 5.0, 4.0};
    memcpy(options.rectangle, rectangle, sizeof rectangle);
    options.step = options.coarse_step = 0.5;
    options.metrics = "g";
    es_metric_map map = 0;
    CHECK_OK(es_map_create(scene, &simulation, &options, &map));
    es_map_info info = {.struct_size = sizeof info};
    CHECK_OK(es_map_get_info(map, &info));
    CHECK(info.points == 80 && info.points_evaluated == 80 && info.sources == 1);
    CHECK(info.outside == 0 && info.near_surface == 0);
    const double *cells = NULL, *points = NULL;
    size_t count = 0;
    CHECK_OK(es_map_cells(map, &cells, &count));
    CHECK(count == 80);
    CHECK_NEAR(cells[4 * 79 + 2], 5.0, 1e-12);
    CHECK_OK(es_map_points(map, &points, &count));
    CHECK_NEAR(points[0], 0.25, 1e-12);
    CHECK_NEAR(points[1], 1.2, 0.0);

    const char *name = NULL, *unit = NULL;
    double jnd = 0.0;
    int32_t relative = 1;
    CHECK_OK(es_map_metric(map, 0, &name, &unit, &jnd, &relative));
    CHECK_TEXT(name, "g");
    CHECK_TEXT(unit, "dB");
    CHECK(jnd == 1.0 && relative == 0);

    // G falls with the distance: the two shares of a limit make up all.
    es_map_limit above = {.struct_size = sizeof above}, below = {.struct_size = sizeof below};
    CHECK_OK(es_map_evaluate_limit(map, 0, 0, 23.0, 1, &above));
    CHECK_OK(es_map_evaluate_limit(map, 0, 0, 23.0, 0, &below));
    CHECK(above.share > 0.05 && above.share < 0.95);
    CHECK_NEAR(above.share + below.share, 1.0, 1e-12);
    CHECK(above.worst < 23.0 && below.worst > 23.0);
    double first[3 * 4];
    uint32_t lines[4];
    CHECK_OK(es_map_contour(map, 0, 0, 23.0, NULL, NULL, 0, &count));
    CHECK(count > 4);
    CHECK_OK(es_map_contour(map, 0, 0, 23.0, first, lines, 4, &count));
    CHECK(lines[0] == 0);
    CHECK_NEAR(first[1], 1.2, 1e-12);

    CHECK_OK(es_map_write(map, "map.csv"));
    CHECK_OK(es_map_write(map, "map.json"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "neither", es_map_write(map, "map.txt"));

    CHECK_OK(es_map_draw(map, 0, 0, scene, 23.0, "map.svg"));
    CHECK_OK(es_map_draw(map, 0, 0, 0, NAN, "map.png"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "neither", es_map_draw(map, 0, 0, 0, NAN, "map.txt"));
    CHECK_FAILS(ES_ERROR_INDEX, "metric", es_map_draw(map, 0, 1, 0, NAN, "map.svg"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "limit", es_map_draw(map, 0, 0, 0, INFINITY, "map.svg"));
    CHECK_OK(es_release(map));
    CHECK_OK(es_release(scene));
}

static void test_errors_of_maps(void) {
    es_scene scene = make_room(0.36);
    es_simulation_options simulation = early_options(0);
    es_map_options options = map_options();
    es_metric_map map = 0;
    CHECK_FAILS(ES_ERROR_FAILED, "empty", es_map_create(scene, &simulation, &options, &map));
    options.rectangle[2] = options.rectangle[3] = 1.0;
    options.metrics = "t3O";
    CHECK_FAILS(ES_ERROR_FAILED, "t3O", es_map_create(scene, &simulation, &options, &map));
    options.metrics = NULL;
    options.step = 0.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "step", es_map_create(scene, &simulation, &options, &map));
    options.step = 0.5;
    options.coarse_step = 0.1;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "coarse", es_map_create(scene, &simulation, &options, &map));
    options.coarse_step = 0.0;
    options.area = ES_MAP_SURFACE;
    options.material = 99;
    CHECK_FAILS(ES_ERROR_INDEX, "material", es_map_create(scene, &simulation, &options, &map));
    options.area = 3;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "area", es_map_create(scene, &simulation, &options, &map));
    CHECK(map == 0);

    es_map_info info = {.struct_size = sizeof info};
    CHECK_FAILS(ES_ERROR_HANDLE, "give a handle of a map", es_map_get_info(0, &info));
    CHECK_FAILS(ES_ERROR_HANDLE, "of a scene", es_map_get_info(scene, &info));
    const double point[] = {3.5, 1.2, 2.5};
    options = map_options();
    options.area = ES_MAP_POINTS;
    options.points = point;
    options.point_count = 1;
    CHECK_OK(es_map_create(scene, &simulation, &options, &map));
    CHECK_OK(es_release(map));
    CHECK_FAILS(ES_ERROR_HANDLE, "of a map that was released", es_map_get_info(map, &info));
    CHECK_OK(es_release(scene));
}

void test_maps(void) {
    test_values_are_those_of_listeners();
    test_areas_and_limits();
    test_errors_of_maps();
}
