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

void test_visible_sets(void) {
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
