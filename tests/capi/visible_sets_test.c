// SPDX-License-Identifier: MIT
// Visible sets, of a file of `earshot pvs build` for scenes/coupled_rooms.gltf.
#include "check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void test_cells(es_visible_sets sets, const es_visible_sets_info* info) {
    // The middle of the region is in a cell, and what is far away in none.
    const double points[6] = {0.5 * (info->lower[0] + info->upper[0]),
                              0.5 * (info->lower[1] + info->upper[1]),
                              0.5 * (info->lower[2] + info->upper[2]),
                              1e9,
                              0.0,
                              0.0};
    uint32_t cells[2] = {0, 0};
    CHECK_OK(es_visible_sets_locate(sets, points, 2, cells));
    CHECK(cells[0] < info->cells && cells[1] == ES_NONE);
    const double nan[3] = {NAN, 0, 0};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "points[0]", es_visible_sets_locate(sets, nan, 1, cells));
    CHECK_FAILS(ES_ERROR_NULL, "points", es_visible_sets_locate(sets, NULL, 1, cells));
    CHECK_FAILS(ES_ERROR_NULL, "cells", es_visible_sets_locate(sets, points, 1, NULL));

    // The cells fill the region.
    const double* volumes = NULL;
    size_t count = 0;
    double sum = 0.0, region = 1.0;
    CHECK_OK(es_visible_sets_volumes(sets, &volumes, &count));
    CHECK(count == info->cells);
    for (size_t i = 0; i < count; ++i) {
        sum += volumes[i];
    }
    for (int axis = 0; axis < 3; ++axis) {
        region *= info->upper[axis] - info->lower[axis];
    }
    CHECK_NEAR(sum / region, 1.0, 1e-9);
    CHECK_FAILS(ES_ERROR_NULL, "volumes", es_visible_sets_volumes(sets, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_visible_sets_volumes(sets, &volumes, NULL));
}

static void test_contents(es_visible_sets sets, const es_visible_sets_info* info) {
    // Triangles of a cell are those of its objects.
    const uint32_t *of_triangle = NULL, *objects = NULL;
    size_t triangle_count = 0, count = 0, entries = 0;
    CHECK_OK(es_visible_sets_object_of_triangle(sets, &of_triangle, &triangle_count));
    CHECK(triangle_count == info->triangles);
    uint32_t* triangles = malloc(triangle_count * sizeof *triangles);
    for (uint32_t cell = 0; cell < info->cells; ++cell) {
        size_t visible = 0, again = 0, expected = 0;
        CHECK_OK(es_visible_sets_objects(sets, cell, &objects, &count));
        entries += count;
        CHECK_OK(es_visible_sets_triangles(sets, cell, NULL, 0, &visible));
        CHECK_OK(es_visible_sets_triangles(sets, cell, triangles, triangle_count, &again));
        CHECK(visible == again);
        for (uint32_t triangle = 0; triangle < triangle_count; ++triangle) {
            for (size_t i = 0; i < count; ++i) {
                if (objects[i] == of_triangle[triangle]) {
                    CHECK(triangles[expected] == triangle);
                    ++expected;
                }
            }
        }
        CHECK(expected == visible);
    }
    CHECK(entries == info->entries);
    // No more than there is room for.
    triangles[1] = 77;
    CHECK_OK(es_visible_sets_triangles(sets, 0, triangles, 1, &count));
    CHECK(count > 1 && triangles[1] == 77);
    free(triangles);
    const uint32_t cells = (uint32_t)info->cells;
    CHECK_FAILS(ES_ERROR_INDEX, "cell", es_visible_sets_objects(sets, cells, &objects, &count));
    CHECK_FAILS(ES_ERROR_NULL, "objects", es_visible_sets_objects(sets, 0, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_visible_sets_objects(sets, 0, &objects, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "cell", es_visible_sets_triangles(sets, ES_NONE, NULL, 0, &count));
    CHECK_FAILS(ES_ERROR_NULL, "triangles", es_visible_sets_triangles(sets, 0, NULL, 1, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_visible_sets_triangles(sets, 0, NULL, 0, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "objects", es_visible_sets_object_of_triangle(sets, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_visible_sets_object_of_triangle(sets, &objects, NULL));
}

/// Sets of the scene serve its simulation; those of another scene do not.
static void test_simulation_with_sets(es_visible_sets sets) {
    es_scene scene = 0, other = make_room(0.5);
    es_simulation_options options = early_options(1);
    es_result result = 0;
    options.metrics = 0;
    options.visible_sets = sets;
    CHECK_OK(es_scene_load(project_file("scenes/coupled_rooms.gltf"), NULL, &scene));
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK_OK(es_release(result));
    CHECK_FAILS(ES_ERROR_FAILED, "visible sets", es_simulate(other, &options, &result));
    // A simulator keeps them.
    es_simulator simulator = 0;
    CHECK_OK(es_simulator_create(scene, &options, &simulator));
    CHECK_OK(es_release(sets));
    CHECK_OK(es_simulator_run(simulator, 0.0, &result));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(simulator));
    CHECK_OK(es_release(scene));
    CHECK_OK(es_release(other));
}

/// Asks to stop at the stage that `data` names, and counts how often it was called after that.
struct Stop {
    const char* stage;
    int calls_after;
};

static int32_t stop_at(void* data, const char* stage, uint64_t done, uint64_t total) {
    struct Stop* stop = data;
    (void)done, (void)total;
    if (stop->stage == NULL) {
        ++stop->calls_after;
    } else if (strcmp(stage, stop->stage) == 0) {
        stop->stage = NULL;
        return 1;
    }
    return 0;
}

static void test_building(void) {
    const double region[6] = {1.0, 1.0, 1.0, 4.0, 2.0, 3.0};
    es_scene scene = make_room(0.5);
    es_visible_sets_options options;
    es_visible_sets sets = 0;
    CHECK_OK(es_visible_sets_options_init(&options, sizeof options));
    options.rays = 20000;
    options.region = region;
    CHECK_OK(es_visible_sets_build(scene, &options, &sets));
    es_visible_sets_info info = {.struct_size = sizeof info};
    CHECK_OK(es_visible_sets_get_info(sets, &info));
    // From within a box all of its twelve triangles are seen, in all directions.
    size_t count = 0;
    CHECK(info.cells == 1 && info.lower[1] == 1.0 && info.upper[0] == 4.0);
    CHECK_OK(es_visible_sets_triangles(sets, 0, NULL, 0, &count));
    CHECK(count == 12 && info.triangles == 12);
    CHECK(info.validation_rays == 65536 && info.missed_share == 0.0);
    CHECK(info.missed_share_upper > 0.0 && info.missed_share_upper < 1e-4);

    // What was written is read again.
    es_visible_sets again = 0;
    CHECK_OK(es_visible_sets_write(sets, "box.pvs"));
    CHECK_OK(es_visible_sets_read("box.pvs", &again));
    CHECK_OK(es_visible_sets_get_info(again, &info));
    CHECK(info.validation_rays == 65536 && info.triangles == 12);
    CHECK_OK(es_release(again));
    CHECK_FAILS(ES_ERROR_FAILED, "none", es_visible_sets_write(sets, "none/box.pvs"));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_visible_sets_write(sets, NULL));
    CHECK_OK(es_release(sets));

    // Without validation nothing is known of what is missed.
    options.validation_rays = 0;
    CHECK_OK(es_visible_sets_build(scene, &options, &sets));
    CHECK_OK(es_visible_sets_get_info(sets, &info));
    CHECK(info.validation_rays == 0 && isnan(info.missed_share) && isnan(info.missed_share_upper));
    CHECK_OK(es_release(sets));
    options.validation_rays = -1;

    // A callback stops each stage.
    const char* stages[] = {"view cells", "rays", "validation rays"};
    options.cells = 4;
    options.threads = 1;
    for (size_t i = 0; i < 3; ++i) {
        struct Stop stop = {stages[i], 0};
        options.progress = stop_at;
        options.progress_data = &stop;
        sets = 77;
        CHECK_FAILS(ES_ERROR_CANCELLED, "cancelled", es_visible_sets_build(scene, &options, &sets));
        CHECK(stop.stage == NULL && stop.calls_after == 0 && sets == 77);
    }
    CHECK_OK(es_release(scene));
}

#define WRONG_SETS(member, value, status, text)                                     \
    do {                                                                            \
        es_visible_sets_options wrong = options;                                    \
        wrong.member = (value);                                                     \
        CHECK_FAILS((status), (text), es_visible_sets_build(scene, &wrong, &sets)); \
    } while (0)

static void test_building_errors(void) {
    const double turned[6] = {1.0, 1.0, 3.0, 4.0, 2.0, 1.0}, nan[6] = {0, 0, 0, NAN, 1, 1};
    const uint32_t none[3] = {1, 0, 1}, many[3] = {1024, 1024, 2},
                   huge[3] = {1U << 20, 1U << 20, 9};
    es_scene scene = make_room(0.5), empty = 0;
    es_visible_sets sets = 0;
    es_visible_sets_options options;
    CHECK_FAILS(ES_ERROR_NULL, "struct", es_visible_sets_options_init(NULL, sizeof options));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_visible_sets_options_init(&options, 8));
    CHECK_OK(es_visible_sets_options_init(&options, sizeof options));
    CHECK(options.triangles_per_object == 1 && options.until == -1 && isinf(options.seconds));
    WRONG_SETS(struct_size, 8, ES_ERROR_ARGUMENT, "options->struct_size");
    WRONG_SETS(time, NAN, ES_ERROR_ARGUMENT, "options->time");
    WRONG_SETS(region, turned, ES_ERROR_ARGUMENT, "lower corner above");
    WRONG_SETS(region, nan, ES_ERROR_ARGUMENT, "options->region[1]");
    WRONG_SETS(cells, (1U << 20) + 1, ES_ERROR_ARGUMENT, "options->cells");
    WRONG_SETS(grid, none, ES_ERROR_ARGUMENT, "options->grid");
    WRONG_SETS(grid, many, ES_ERROR_ARGUMENT, "cells of options->grid");
    WRONG_SETS(grid, huge, ES_ERROR_ARGUMENT, "cells of options->grid");
    WRONG_SETS(triangles_per_object, 0, ES_ERROR_ARGUMENT, "triangles_per_object");
    WRONG_SETS(rays, UINT64_MAX, ES_ERROR_ARGUMENT, "options->rays");
    WRONG_SETS(until, -2, ES_ERROR_ARGUMENT, "options->until");
    WRONG_SETS(validation_rays, -2, ES_ERROR_ARGUMENT, "options->validation_rays");
    WRONG_SETS(segments, 0, ES_ERROR_ARGUMENT, "options->segments");
    WRONG_SETS(seconds, -1.0, ES_ERROR_ARGUMENT, "options->seconds");
    WRONG_SETS(seconds, NAN, ES_ERROR_ARGUMENT, "options->seconds");
    WRONG_SETS(seed, UINT64_MAX, ES_ERROR_ARGUMENT, "options->seed");
    WRONG_SETS(skip_solids, 2, ES_ERROR_ARGUMENT, "options->skip_solids");
    WRONG_SETS(threads, -1, ES_ERROR_ARGUMENT, "options->threads");
    options.cells = 2;
    WRONG_SETS(grid, many, ES_ERROR_ARGUMENT, "beside options->cells");
    CHECK_FAILS(ES_ERROR_NULL, "sets", es_visible_sets_build(scene, &options, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "scene", es_visible_sets_build(0, &options, &sets));
    es_scene_arrays arrays;
    CHECK_OK(es_scene_arrays_init(&arrays, sizeof arrays));
    CHECK_OK(es_scene_create(&arrays, &empty));
    CHECK_FAILS(ES_ERROR_FAILED, "no triangles", es_visible_sets_build(empty, NULL, &sets));
    CHECK_OK(es_release(empty));
    CHECK_OK(es_release(scene));
}

void test_visible_sets(void) {
    test_building();
    test_building_errors();
    es_visible_sets sets = 0;
    CHECK_FAILS(ES_ERROR_FAILED, "none.pvs", es_visible_sets_read("none.pvs", &sets));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_visible_sets_read(NULL, &sets));
    CHECK_FAILS(ES_ERROR_NULL, "sets", es_visible_sets_read("rooms.pvs", NULL));
    CHECK_OK(es_visible_sets_read("rooms.pvs", &sets));
    CHECK(es_kind_of(sets) == ES_KIND_VISIBLE_SETS);
    es_visible_sets_info info = {.struct_size = sizeof info};
    CHECK_OK(es_visible_sets_get_info(sets, &info));
    CHECK(info.cells == 8 && info.objects > 0 && info.rays > 0 && info.mesh_digest != 0);
    CHECK_TEXT(info.scene, "coupled_rooms.gltf");
    CHECK_NEAR(info.time, 0.0, 0.0);
    CHECK(info.seed == 1);
    CHECK_FAILS(ES_ERROR_NULL, "info", es_visible_sets_get_info(sets, NULL));
    es_visible_sets_info wrong = {.struct_size = 1};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_visible_sets_get_info(sets, &wrong));
    test_cells(sets, &info);
    test_contents(sets, &info);
    test_simulation_with_sets(sets);
}
