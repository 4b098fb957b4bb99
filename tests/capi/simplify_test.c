// SPDX-License-Identifier: MIT
// Scenes with fewer triangles.
#include "check.h"
#include <math.h>
#include <string.h>

static void test_options(void) {
    es_simplify_options options;
    CHECK_OK(es_simplify_options_init(&options, sizeof options));
    CHECK(options.distance == 0.01 && isnan(options.object_size));
    es_scene scene = make_room(0.3);
    es_scene simplified = 0;
    options.distance = -1.0;
    CHECK(es_scene_simplify(scene, &options, NULL, &simplified) == ES_ERROR_ARGUMENT);
    CHECK(es_scene_simplify(scene, NULL, NULL, NULL) == ES_ERROR_NULL);
    CHECK(es_scene_simplify(0, NULL, NULL, &simplified) == ES_ERROR_HANDLE);
    CHECK(simplified == 0);
    CHECK_OK(es_release(scene));
}

static void test_room(void) {
    es_scene scene = make_room(0.3);
    const char* text = NULL;
    CHECK_OK(es_scene_simplification_json(scene, &text));
    CHECK(strlen(text) == 0);
    const es_simulation_options simulation = early_options(1);
    es_scene simplified = 0;
    const es_status status = es_scene_simplify(scene, NULL, &simulation, &simplified);
    if (status == ES_ERROR_FAILED && strstr(es_error_message(), "without OpenMesh") != NULL) {
        CHECK_OK(es_release(scene));
        return;
    }
    CHECK(status == ES_OK);
    CHECK(es_kind_of(simplified) == ES_KIND_SCENE);
    CHECK_OK(es_scene_simplification_json(simplified, &text));
    CHECK(strstr(text, "\"triangles\":{\"before\":12,\"after\":12}") != NULL);
    CHECK(strstr(text, "\"pairs\"") != NULL);
    CHECK_OK(es_scene_write(simplified, "room.glb"));
    es_scene again = 0;
    CHECK_OK(es_scene_load("room.glb", NULL, &again));
    CHECK_OK(es_release(again));
    CHECK_OK(es_release(simplified));
    CHECK_OK(es_release(scene));
}

void test_simplifications(void) {
    test_options();
    test_room();
}
