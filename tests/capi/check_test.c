// SPDX-License-Identifier: MIT
// Checks of models and mended copies.
#include "check.h"

#include <stdio.h>
#include <string.h>

/// A room of 6 x 3 x 4 m, its fronts inside, with a box of 1 m of which the fronts look inside too
/// (the last 12 triangles before the doubled one), one triangle doubled.
static es_scene faulty_room(void) {
    static double vertices[16][3];
    static uint32_t triangles[25][3];
    static const uint32_t sides[6][4] = {
        {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    const double low[2][3] = {{0, 0, 0}, {1, 1, 1}}, high[2][3] = {{6, 3, 4}, {2, 2, 2}};
    for (uint32_t box = 0; box < 2; ++box) {
        for (uint32_t corner = 0; corner < 8; ++corner) {
            for (uint32_t axis = 0; axis < 3; ++axis) {
                vertices[8 * box + corner][axis] =
                    (corner >> axis & 1U) != 0 ? high[box][axis] : low[box][axis];
            }
        }
        for (uint32_t side = 0; side < 6; ++side) {
            for (uint32_t half = 0; half < 2; ++half) {
                uint32_t* triangle = triangles[12 * box + 2 * side + half];
                triangle[0] = 8 * box + sides[side][0];
                triangle[1] = 8 * box + sides[side][1 + half];
                triangle[2] = 8 * box + sides[side][2 + half];
            }
        }
    }
    memcpy(triangles[24], triangles[0], sizeof triangles[0]);
    es_scene_arrays arrays;
    CHECK_OK(es_scene_arrays_init(&arrays, sizeof arrays));
    arrays.vertices = vertices[0];
    arrays.vertex_count = 16;
    arrays.triangles = triangles[0];
    arrays.triangle_count = 25;
    es_scene scene = 0;
    CHECK_OK(es_scene_create(&arrays, &scene));
    const double source[3] = {4, 1, 1}, listener[3] = {9, 1, 1};
    CHECK_OK(es_scene_add(scene, ES_SOURCES, source, NULL, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, listener, NULL, 1, NULL));
    return scene;
}

static void check_lists(es_model_check found) {
    size_t count = 0;
    const es_misplaced* misplaced = NULL;
    CHECK_OK(es_check_misplaced(found, &misplaced, &count));
    CHECK(count == 2 && misplaced[1].item == ES_LISTENERS && misplaced[1].index == 0);
    CHECK(misplaced[1].fault == ES_OUTSIDE && misplaced[1].proven == 1);
    CHECK_NEAR(misplaced[1].position[0], 9.0, 0.0);

    const es_face_group* groups = NULL;
    CHECK_OK(es_check_faces(found, ES_REVERSED, &groups, &count));
    CHECK(count == 1 && groups[0].triangles == 12 && groups[0].first_triangle == 12);
    CHECK_NEAR(groups[0].place.centre[1], 1.5, 1e-12);
    CHECK_OK(es_check_faces(found, ES_DOUBLED, &groups, &count));
    CHECK(count == 1 && groups[0].first_triangle == 24 && groups[0].is_reversed == 0);

    const uint32_t* numbers = NULL;
    CHECK_OK(es_check_triangles(found, ES_REVERSED_TRIANGLES, &numbers, &count));
    CHECK(count == 12 && numbers[0] == 12 && numbers[11] == 23);
    CHECK_OK(es_check_triangles(found, ES_UNREACHED, &numbers, &count));
    CHECK(count == 0);
    CHECK_OK(es_check_air_of(found, ES_SOURCES, &numbers, &count));
    CHECK(count == 1 && numbers[0] == 0);
    const es_air* airs = NULL;
    CHECK_OK(es_check_airs(found, &airs, &count));
    CHECK(count == 2);
    CHECK_NEAR(airs[0].volume, 71.0, 1e-9);

    const es_material_use* materials = NULL;
    CHECK_OK(es_check_materials(found, &materials, &count));
    CHECK(count == 1 && materials[0].origin == ES_DATA_NONE);
    CHECK_NEAR(materials[0].absorption_share, 1.0, 1e-12);
    CHECK_TEXT(materials[0].doubts, "");
    const es_small_facets* octaves = NULL;
    CHECK_OK(es_check_small_facets(found, &octaves, &count));
    CHECK(count == 7 && octaves[0].frequency == 125.0 && octaves[0].facets == 0);
    const es_leak* leaks = NULL;
    CHECK_OK(es_check_leaks(found, &leaks, &count));
    CHECK(count == 0);
    const es_hole* holes = NULL;
    CHECK_OK(es_check_holes(found, &holes, &count));
    CHECK(count == 0);
    const es_order_cost* costs = NULL;
    CHECK_OK(es_check_costs(found, &costs, &count));
    CHECK(count == 0);
}

static void check_mending(es_model_check found) {
    es_mend_options options;
    CHECK_OK(es_mend_options_init(&options, sizeof options));
    es_mending mending = 0;
    CHECK_OK(es_mending_create(found, &options, &mending));
    CHECK(es_kind_of(mending) == ES_KIND_MENDING);
    const uint32_t* numbers = NULL;
    size_t count = 0;
    CHECK_OK(es_mending_triangles(mending, ES_TURNED, &numbers, &count));
    CHECK(count == 12 && numbers[0] == 12);
    CHECK_OK(es_mending_triangles(mending, ES_REMOVED_DOUBLED, &numbers, &count));
    CHECK(count == 1 && numbers[0] == 24);
    CHECK_OK(es_mending_triangles(mending, ES_KEPT_UNREACHED, &numbers, &count));
    CHECK(count == 0);
    es_mending_info info = {.struct_size = sizeof info};
    CHECK_OK(es_mending_get_info(mending, &info));
    CHECK(info.filled_holes == 0 && info.max_rounding == 0.0);
    es_scene mended = 0;
    CHECK_OK(es_mending_scene(mending, &mended));
    CHECK_OK(es_scene_count(mended, ES_TRIANGLES, &count));
    CHECK(count == 24);
    CHECK_OK(es_scene_count(mended, ES_LISTENERS, &count));
    CHECK(count == 1);
    CHECK_OK(es_mending_write(mending, "mended.glb"));
    es_scene read = 0;
    CHECK_OK(es_scene_load("mended.glb", NULL, &read));
    CHECK_OK(es_scene_count(read, ES_TRIANGLES, &count));
    CHECK(count == 24);
    CHECK_FAILS(ES_ERROR_ARGUMENT, ".glb", es_mending_write(mending, "mended.obj"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "list", es_mending_triangles(mending, 5, &numbers, &count));
    options.max_hole_area = -1.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "max_hole_area", es_mending_create(found, &options, &mending));
    CHECK_OK(es_release(read));
    CHECK_OK(es_release(mended));
    CHECK_OK(es_release(mending));
}

static int32_t stop(void* user_data, const char* stage, uint64_t done, uint64_t total) {
    (void)user_data, (void)stage, (void)done, (void)total;
    return 1;
}

static void test_errors_of_checks(es_scene scene) {
    es_check_options options;
    CHECK_OK(es_check_options_init(&options, sizeof options));
    es_model_check found = 0;
    options.rays = 10;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "rays", es_check_create(scene, &options, &found));
    options.rays = 1000;
    options.crack = 2.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "crack", es_check_create(scene, &options, &found));
    options.crack = 0.01;
    options.progress = stop;
    CHECK_FAILS(ES_ERROR_CANCELLED, "", es_check_create(scene, &options, &found));
    CHECK_FAILS(ES_ERROR_NULL, "check", es_check_create(scene, NULL, NULL));
    CHECK(found == 0);
}

/// A scene that moves is mended as it is at an instant only.
static void test_moving_scenes(void) {
    es_scene scene = 0;
    CHECK_OK(es_scene_load(project_file("scenes/door.gltf"), NULL, &scene));
    es_check_options options;
    CHECK_OK(es_check_options_init(&options, sizeof options));
    options.time = 1.0;
    es_model_check found = 0;
    CHECK_OK(es_check_create(scene, &options, &found));
    es_mending mending = 0;
    CHECK_FAILS(ES_ERROR_FAILED, "moves", es_mending_create(found, NULL, &mending));
    es_mend_options mend;
    CHECK_OK(es_mend_options_init(&mend, sizeof mend));
    mend.freeze = 1;
    CHECK_OK(es_mending_create(found, &mend, &mending));
    CHECK_OK(es_release(mending));
    CHECK_OK(es_release(found));
    CHECK_OK(es_release(scene));
}

void test_checks(void) {
    es_scene scene = faulty_room();
    es_model_check found = 0;
    if (es_has_check() == 0) {
        CHECK_FAILS(ES_ERROR_FAILED, "OpenMesh", es_check_create(scene, NULL, &found));
        return;
    }
    CHECK_OK(es_check_create(scene, NULL, &found));
    CHECK(es_kind_of(found) == ES_KIND_MODEL_CHECK);
    // The check has a copy of its own.
    CHECK_OK(es_release(scene));
    es_check_info info = {.struct_size = sizeof info};
    CHECK_OK(es_check_get_info(found, &info));
    CHECK(info.verdict == ES_UNUSABLE && info.findings >= 4 && info.airs == 2);
    CHECK(info.outdoors == 0 && info.open == 0 && info.rays > 0);
    CHECK_NEAR(info.upper[0], 6.0, 0.0);
    CHECK_NEAR(info.volume, 71.0, 1e-9);
    CHECK_TEXT(info.unit, "");
    int32_t severity = 0;
    const char* text = NULL;
    // The source comes first: it has no listener.
    CHECK_OK(es_check_finding(found, 1, &severity, &text));
    CHECK(severity == ES_UNUSABLE && strstr(text, "outside of the room") != NULL);
    CHECK_FAILS(ES_ERROR_INDEX, "", es_check_finding(found, info.findings, &severity, &text));
    check_lists(found);
    check_mending(found);
    CHECK_OK(es_check_write(found, "check.json"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, ".json", es_check_write(found, "check.txt"));
    CHECK_OK(es_release(found));
    scene = faulty_room();
    test_errors_of_checks(scene);
    CHECK_OK(es_release(scene));
    test_moving_scenes();
}
