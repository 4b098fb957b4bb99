// SPDX-License-Identifier: MIT
// Sources and listeners.
#include "check.h"
#include <math.h>
#include <stdio.h>

static void check_name(es_scene scene, int32_t item, size_t index, const char* expected) {
    const char* name = NULL;
    CHECK_OK(es_scene_item_name(scene, item, index, &name));
    CHECK_TEXT(name, expected);
}

static void test_adding(void) {
    es_scene scene = make_room(0.5);
    check_name(scene, ES_SOURCES, 0, "source1");
    check_name(scene, ES_LISTENERS, 0, "listener1");
    double positions[27 * 3];
    for (int i = 0; i < 27; ++i) {
        positions[3 * i] = 1.0 + 0.1 * (i % 3);
        positions[3 * i + 1] = 1.0 + 0.1 * (i / 3 % 3);
        positions[3 * i + 2] = 1.0 + 0.1 * (i / 9);
    }
    uint32_t first = 99;
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, positions, NULL, 27, &first));
    CHECK(first == 1);
    check_name(scene, ES_LISTENERS, 27, "listener28");
    const char* names[] = {"seat", NULL, ""};
    CHECK_OK(es_scene_add(scene, ES_SOURCES, positions, names, 3, &first));
    CHECK(first == 1);
    check_name(scene, ES_SOURCES, 1, "seat");
    check_name(scene, ES_SOURCES, 2, "source3");
    check_name(scene, ES_SOURCES, 3, "source4");
    // A number that is taken is passed over.
    const char* taken[] = {"source6"};
    CHECK_OK(es_scene_add(scene, ES_SOURCES, positions, taken, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_SOURCES, positions, NULL, 1, NULL));
    check_name(scene, ES_SOURCES, 5, "source7");
    CHECK_OK(es_scene_add(scene, ES_SOURCES, NULL, NULL, 0, NULL));

    // A name twice is told, and then nothing is added.
    const char* twice[] = {"new", "new"};
    CHECK_FAILS(
        ES_ERROR_FAILED, "\"new\"", es_scene_add(scene, ES_SOURCES, positions, twice, 2, NULL));
    CHECK_FAILS(
        ES_ERROR_FAILED, "\"seat\"", es_scene_add(scene, ES_SOURCES, positions, names, 1, NULL));
    size_t count = 0;
    CHECK_OK(es_scene_count(scene, ES_SOURCES, &count));
    CHECK(count == 6);
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "item", es_scene_add(scene, ES_MESHES, positions, NULL, 1, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "positions", es_scene_add(scene, ES_SOURCES, NULL, NULL, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "count",
                es_scene_add(scene, ES_SOURCES, positions, NULL, SIZE_MAX, NULL));
    positions[7] = INFINITY;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "positions[2]",
                es_scene_add(scene, ES_SOURCES, positions, NULL, 3, NULL));
    positions[7] = 2e12;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "positions[2]",
                es_scene_add(scene, ES_SOURCES, positions, NULL, 3, NULL));
    const char* no_text[] = {"\xff"};
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "names", es_scene_add(scene, ES_SOURCES, positions, no_text, 1, NULL));

    CHECK_OK(es_scene_remove(scene, ES_SOURCES, 0));
    check_name(scene, ES_SOURCES, 0, "seat");
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_remove(scene, ES_SOURCES, 5));
    CHECK_OK(es_scene_remove(scene, ES_SOURCES, ES_ALL));
    CHECK_OK(es_scene_count(scene, ES_SOURCES, &count));
    CHECK(count == 0);
    CHECK_FAILS(ES_ERROR_INDEX, "there are none", es_scene_remove(scene, ES_SOURCES, 0));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "item", es_scene_remove(scene, ES_MATERIALS, 0));
    CHECK_OK(es_release(scene));
}

static void test_poses(void) {
    es_scene scene = make_room(0.5);
    const double there[3] = {2.0, 1.0, 1.0}, target[3] = {4.0, 1.0, 1.0};
    es_pose pose;
    CHECK_OK(es_scene_set_position(scene, ES_LISTENERS, 0, there));
    CHECK_OK(es_scene_pose(scene, ES_LISTENERS, 0, 0.0, &pose));
    CHECK_NEAR(pose.position[0], 2.0, 0.0);
    CHECK_NEAR(pose.front[2], -1.0, 0.0);  // along -Z without a target
    CHECK_OK(es_scene_set_look_at(scene, ES_LISTENERS, ES_ALL, target));
    CHECK_OK(es_scene_pose(scene, ES_LISTENERS, 0, 0.0, &pose));
    CHECK_NEAR(pose.front[0], 1.0, 1e-15);
    CHECK_NEAR(pose.left[2], -1.0, 1e-15);
    CHECK_NEAR(pose.up[1], 1.0, 1e-15);
    CHECK_OK(es_scene_set_look_at(scene, ES_LISTENERS, 0, NULL));
    CHECK_OK(es_scene_pose(scene, ES_LISTENERS, 0, 0.0, &pose));
    CHECK_NEAR(pose.front[2], -1.0, 0.0);

    const double nowhere[3] = {NAN, 0.0, 0.0};
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "position", es_scene_set_position(scene, ES_LISTENERS, 0, nowhere));
    CHECK_FAILS(ES_ERROR_NULL, "position", es_scene_set_position(scene, ES_LISTENERS, 0, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_set_position(scene, ES_LISTENERS, ES_ALL, there));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "point", es_scene_set_look_at(scene, ES_LISTENERS, 0, nowhere));
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_set_look_at(scene, ES_LISTENERS, 3, target));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "item", es_scene_set_look_at(scene, 9, 0, target));
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_pose(scene, ES_SOURCES, 1, 0.0, &pose));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_scene_pose(scene, ES_SOURCES, 0, NAN, &pose));
    CHECK_FAILS(ES_ERROR_NULL, "pose", es_scene_pose(scene, ES_SOURCES, 0, 0.0, NULL));
    CHECK_OK(es_release(scene));
}

/// The direct sound's pressure at 1 kHz, times its length: the source's factor, but for the air.
static double direct_factor(es_scene scene) {
    es_simulation_options options = early_options(0);
    options.air_absorption = 0;
    options.metrics = 0;
    options.responses = 0;
    es_result result = 0;
    es_path_arrays arrays = {.struct_size = sizeof arrays};
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK_OK(es_result_paths(result, &arrays));
    CHECK(arrays.path_count == 1);
    const double factor = arrays.pressure[5] * arrays.paths[0].length;
    CHECK_OK(es_release(result));
    return factor;
}

static void test_directivities(void) {
    es_scene scene = make_room(0.5);
    const double source[3] = {1.0, 1.5, 1.0}, listener[3] = {3.0, 1.5, 1.0},
                 side[3] = {1.0, 1.5, 3.0};
    CHECK_OK(es_scene_set_position(scene, ES_SOURCES, 0, source));
    CHECK_OK(es_scene_set_position(scene, ES_LISTENERS, 0, listener));
    CHECK_NEAR(direct_factor(scene), 1.0, 1e-12);
    // The listener is 90 degrees off the front: a cardioid sends half the pressure.
    CHECK_OK(es_scene_set_look_at(scene, ES_SOURCES, 0, side));
    CHECK_OK(es_scene_set_directivity(scene, ES_ALL, "cardioid"));
    CHECK_NEAR(direct_factor(scene), 0.5, 1e-12);
    // To the left: it is 6 dB down at azimuth 90, 12 dB at 270.
    const double frequencies[] = {1000.0}, azimuths[] = {0.0, 90.0, 180.0, 270.0},
                 elevations[] = {0.0};
    const double levels[] = {0.0, -6.0, -20.0, -12.0};
    CHECK_OK(es_scene_set_directivity_table(
        scene, 0, frequencies, 1, azimuths, 4, elevations, 1, levels));
    CHECK_NEAR(direct_factor(scene), pow(10.0, -6.0 / 20.0), 1e-9);

    CHECK_FAILS(ES_ERROR_FAILED, "triangular", es_scene_set_directivity(scene, 0, "triangular"));
    CHECK_FAILS(ES_ERROR_FAILED, "none.csv", es_scene_set_directivity(scene, 0, "none.csv"));
    CHECK_FAILS(ES_ERROR_NULL, "name", es_scene_set_directivity(scene, 0, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_set_directivity(scene, 1, "omni"));
    const double falling[] = {90.0, 0.0, 180.0, 270.0}, not_finite[] = {0.0, NAN, 0.0, 0.0};
    CHECK_FAILS(ES_ERROR_FAILED,
                "",
                es_scene_set_directivity_table(
                    scene, 0, frequencies, 1, falling, 4, elevations, 1, levels));
    CHECK_FAILS(ES_ERROR_FAILED,
                "",
                es_scene_set_directivity_table(
                    scene, 0, frequencies, 1, azimuths, 4, elevations, 1, not_finite));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "levels_db",
                es_scene_set_directivity_table(
                    scene, 0, frequencies, 0, azimuths, 4, elevations, 1, levels));
    CHECK_FAILS(
        ES_ERROR_NULL,
        "azimuths",
        es_scene_set_directivity_table(scene, 0, frequencies, 1, NULL, 4, elevations, 1, levels));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "elevations",
                es_scene_set_directivity_table(
                    scene, 0, frequencies, 1, azimuths, 4, elevations, SIZE_MAX, levels));
    CHECK_FAILS(
        ES_ERROR_NULL,
        "levels_db",
        es_scene_set_directivity_table(scene, 0, frequencies, 1, azimuths, 4, elevations, 1, NULL));
    CHECK_OK(es_release(scene));
}

void test_emitters(void) {
    test_adding();
    test_poses();
    test_directivities();
}
