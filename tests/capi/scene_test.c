// SPDX-License-Identifier: MIT
// Scenes: files, contents, messages.
#include "check.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static void write_file(const char* name, const char* text) {
    FILE* file = fopen(name, "w");
    CHECK(file != NULL);
    fputs(text, file);
    fclose(file);
}

static int mentions(es_messages messages, const char* text) {
    size_t count = 0;
    int found = 0;
    CHECK_OK(es_messages_count(messages, &count));
    for (size_t i = 0; i < count; ++i) {
        const char *subject = NULL, *what = NULL;
        CHECK_OK(es_messages_get(messages, i, &subject, &what));
        CHECK(subject != NULL && what != NULL);
        found = found || strstr(subject, text) != NULL || strstr(what, text) != NULL;
    }
    const char *subject = NULL, *what = NULL;
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_messages_get(messages, count, &subject, &what));
    return found;
}

static void test_files(void) {
    es_scene scene = 0;
    CHECK_OK(es_scene_load(project_file("scenes/door.gltf"), NULL, &scene));
    const char* text = NULL;
    CHECK_OK(es_scene_name(scene, &text));
    CHECK_TEXT(text, "door.gltf");
    double duration = -1.0;
    CHECK_OK(es_scene_duration(scene, &duration));
    CHECK_NEAR(duration, 4.0, 1e-6);
    size_t vertices = 0, triangles = 0, sources = 0;
    CHECK_OK(es_scene_count(scene, ES_VERTICES, &vertices));
    CHECK_OK(es_scene_count(scene, ES_TRIANGLES, &triangles));
    CHECK_OK(es_scene_count(scene, ES_SOURCES, &sources));
    CHECK(vertices > 8 && triangles > 12 && sources > 0);
    double position = 0.0;
    CHECK_FAILS(ES_ERROR_FAILED, "animation", es_scene_set_positions(scene, &position, 1));
    CHECK_OK(es_release(scene));

    // A millimetre file with +Z up: 8 x 6 m, 3.5 m high, becomes y-up metres.
    write_file("box.obj",
               "v 0 0 0\nv 8000 0 0\nv 8000 6000 0\nv 0 6000 0\n"
               "v 0 0 3500\nv 8000 0 3500\nv 8000 6000 3500\nv 0 6000 3500\n"
               "usemtl brick-painted\nf 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\n"
               "usemtl odd\nf 4 8 5 1\n");
    write_file("box.materials.json", "{\"odd\": {\"absorption\": 0.5}}");
    es_load_options options;
    CHECK_OK(es_load_options_init(&options, sizeof options));
    options.units = "mm";
    options.up = ES_UP_Z;
    CHECK_OK(es_scene_load("box.obj", &options, &scene));
    double lower[3], upper[3];
    CHECK_OK(es_scene_extent(scene, 0.0, lower, upper));
    CHECK_NEAR(upper[0] - lower[0], 8.0, 1e-9);
    CHECK_NEAR(upper[1] - lower[1], 3.5, 1e-9);
    CHECK_NEAR(upper[2] - lower[2], 6.0, 1e-9);
    uint32_t odd = 9;
    double values[10];
    CHECK_OK(es_scene_find(scene, ES_MATERIALS, "odd", &odd));
    CHECK_OK(es_scene_coefficients(scene, odd, ES_ABSORPTION, ES_BANDS_OCTAVE, values, 10));
    CHECK_NEAR(values[5], 0.5, 0.0);
    CHECK_OK(es_release(scene));

    options.read_materials = 0;
    CHECK_OK(es_scene_load("box.obj", &options, &scene));
    CHECK_OK(es_scene_coefficients(scene, odd, ES_ABSORPTION, ES_BANDS_OCTAVE, values, 10));
    CHECK_NEAR(values[5], 0.1, 0.0);
    es_messages messages = 0;
    CHECK_OK(es_scene_check(scene, 0.0, &messages));
    CHECK(mentions(messages, "odd"));  // it has no data
    CHECK_OK(es_release(messages));
    CHECK_OK(es_release(scene));

    // The same file read as metres is no room.
    CHECK_OK(es_scene_load("box.obj", NULL, &scene));
    CHECK_OK(es_scene_check(scene, 0.0, &messages));
    CHECK(mentions(messages, "mm"));
    CHECK_OK(es_release(messages));
    CHECK_OK(es_scene_warnings(scene, &messages));
    CHECK(!mentions(messages, "mm"));
    CHECK_OK(es_release(messages));
    CHECK_OK(es_release(scene));

    options.units = "furlong";
    CHECK_FAILS(ES_ERROR_ARGUMENT, "furlong", es_scene_load("box.obj", &options, &scene));
    options.units = "m";
    options.up = 5;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "options->up", es_scene_load("box.obj", &options, &scene));
    options.up = ES_UP_Y;
    options.allow_outside = 2;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "allow_outside", es_scene_load("box.obj", &options, &scene));
    options.allow_outside = 0;
    options.animation = "no such";
    CHECK_FAILS(ES_ERROR_FAILED,
                "no such",
                es_scene_load(project_file("scenes/door.gltf"), &options, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "scene", es_scene_load("box.obj", NULL, NULL));
}

static void test_contents(void) {
    es_scene scene = make_room(0.5);
    size_t count = 0;
    const size_t expected[] = {1, 1, 6, 1, 12, 8};
    for (int32_t item = ES_SOURCES; item <= ES_VERTICES; ++item) {
        CHECK_OK(es_scene_count(scene, item, &count));
        CHECK(count == expected[item]);
    }
    CHECK_FAILS(ES_ERROR_ARGUMENT, "item", es_scene_count(scene, 6, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_scene_count(scene, ES_SOURCES, NULL));

    const char* names[] = {"floor", "ceiling", "north", "east", "south", "west"};
    for (uint32_t i = 0; i < 6; ++i) {
        const char* name = NULL;
        uint32_t index = 99;
        CHECK_OK(es_scene_item_name(scene, ES_MATERIALS, i, &name));
        CHECK_TEXT(name, names[i]);
        CHECK_OK(es_scene_find(scene, ES_MATERIALS, names[i], &index));
        CHECK(index == i);
    }
    const char* name = NULL;
    uint32_t index = 0;
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_item_name(scene, ES_MATERIALS, 6, &name));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "item", es_scene_item_name(scene, ES_VERTICES, 0, &name));
    CHECK_FAILS(ES_ERROR_NULL, "name", es_scene_item_name(scene, ES_MATERIALS, 0, NULL));
    CHECK_FAILS(
        ES_ERROR_FAILED, "did you mean floor", es_scene_find(scene, ES_MATERIALS, "flor", &index));
    CHECK_FAILS(ES_ERROR_NULL, "name", es_scene_find(scene, ES_MATERIALS, NULL, &index));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "item", es_scene_find(scene, ES_TRIANGLES, "x", &index));

    // The floor faces up, and every triangle has the plane that its material's name says.
    const uint32_t *triangles = NULL, *materials = NULL, *meshes = NULL;
    double positions[8 * 3];
    CHECK_OK(es_scene_triangles(scene, &triangles, &materials, &meshes, &count));
    CHECK(count == 12);
    CHECK_OK(es_scene_positions(scene, 0.0, positions, 8));
    const int axis_of[] = {1, 1, 2, 0, 2, 0};
    const double at[] = {0.0, 3.0, 0.0, 5.0, 4.0, 0.0};
    const double inward[] = {1.0, -1.0, 1.0, -1.0, -1.0, 1.0};
    for (size_t i = 0; i < count; ++i) {
        const double* corner[3];
        for (int k = 0; k < 3; ++k) {
            corner[k] = positions + 3 * triangles[3 * i + (size_t)k];
            CHECK_NEAR(corner[k][axis_of[materials[i]]], at[materials[i]], 0.0);
        }
        const int a = (axis_of[materials[i]] + 1) % 3, b = (axis_of[materials[i]] + 2) % 3;
        const double normal = (corner[1][a] - corner[0][a]) * (corner[2][b] - corner[0][b]) -
                              (corner[1][b] - corner[0][b]) * (corner[2][a] - corner[0][a]);
        CHECK(normal * inward[materials[i]] > 0.0);
        CHECK(meshes[i] == 0);
    }
    CHECK_OK(es_scene_triangles(scene, NULL, NULL, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_scene_triangles(scene, NULL, NULL, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "vertex_count", es_scene_positions(scene, 0.0, positions, 7));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_scene_positions(scene, NAN, positions, 8));
    CHECK_FAILS(ES_ERROR_NULL, "positions", es_scene_positions(scene, 0.0, NULL, 8));

    // A copy does not follow.
    es_scene copy = 0;
    CHECK_OK(es_scene_copy(scene, &copy));
    for (size_t i = 0; i < 8; ++i) {
        positions[3 * i + 1] *= 2.0;
    }
    CHECK_OK(es_scene_set_positions(scene, positions, 8));
    double lower[3], upper[3];
    CHECK_OK(es_scene_extent(scene, 0.0, lower, upper));
    CHECK_NEAR(upper[1], 6.0, 0.0);
    CHECK_OK(es_scene_extent(copy, 0.0, lower, upper));
    CHECK_NEAR(upper[1], 3.0, 0.0);
    CHECK_FAILS(ES_ERROR_NULL, "lower", es_scene_extent(copy, 0.0, NULL, upper));
    CHECK_FAILS(ES_ERROR_NULL, "upper", es_scene_extent(copy, 0.0, lower, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_scene_extent(copy, INFINITY, lower, upper));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "vertex_count", es_scene_set_positions(scene, positions, 9));
    positions[4] = NAN;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "positions[1]", es_scene_set_positions(scene, positions, 8));
    CHECK_FAILS(ES_ERROR_NULL, "copy", es_scene_copy(scene, NULL));

    // A listener behind the wall is told.
    const double outside[3] = {50.0, 1.0, 1.0};
    es_messages messages = 0;
    CHECK_OK(es_scene_check(copy, 0.0, &messages));
    CHECK(!mentions(messages, "listener1"));
    CHECK_OK(es_release(messages));
    CHECK_OK(es_scene_set_position(copy, ES_LISTENERS, 0, outside));
    CHECK_OK(es_scene_check(copy, 0.0, &messages));
    CHECK(mentions(messages, "listener1"));
    CHECK_OK(es_release(messages));
    CHECK_FAILS(ES_ERROR_NULL, "messages", es_scene_check(copy, 0.0, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "messages", es_scene_warnings(copy, NULL));
    double duration = 1.0;
    CHECK_OK(es_scene_duration(copy, &duration));
    CHECK_NEAR(duration, 0.0, 0.0);
    CHECK_FAILS(ES_ERROR_NULL, "duration", es_scene_duration(copy, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "name", es_scene_name(copy, NULL));
    CHECK_OK(es_release(copy));
    CHECK_OK(es_release(scene));
}

void test_scenes(void) {
    test_files();
    test_contents();
    size_t count = 0;
    CHECK_FAILS(ES_ERROR_HANDLE, "messages", es_messages_count(0, &count));
}
