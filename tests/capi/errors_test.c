// SPDX-License-Identifier: MIT
// Versions, status codes, messages, handles.
#include "check.h"
#include <math.h>
#include <string.h>

void test_errors(void) {
    CHECK(es_version() == ES_VERSION);
    CHECK(es_version() ==
          ((uint32_t)ES_VERSION_MAJOR << 16 | ES_VERSION_MINOR << 8 | ES_VERSION_PATCH));
    CHECK_TEXT(es_version_text(), "0.1.0");
    CHECK_TEXT(es_status_name(ES_OK), "ES_OK");
    CHECK_TEXT(es_status_name(ES_ERROR_INTERNAL), "ES_ERROR_INTERNAL");
    CHECK_TEXT(es_status_name(10), "unknown");
    CHECK_TEXT(es_status_name(-1), "unknown");

    // Nothing has failed yet.
    CHECK(es_error_status() == ES_OK);
    CHECK_TEXT(es_error_message(), "");
    CHECK_TEXT(es_error_subject(), "");

    // Subject, problem and remedy make the message.
    es_scene scene = 77;
    CHECK_FAILS(ES_ERROR_FAILED, "nothing.obj", es_scene_load("nothing.obj", NULL, &scene));
    CHECK_TEXT(es_error_subject(), "nothing.obj");
    CHECK_TEXT(es_error_problem(), "no such file");
    CHECK_TEXT(es_error_remedy(), "check the name and the directory");
    CHECK_TEXT(es_error_message(), "nothing.obj: no such file; check the name and the directory");
    CHECK(scene == 77);  // what a failed call would write to is left as it was

    // Calls that succeed leave the message.
    CHECK_OK(es_release(0));
    CHECK_TEXT(es_error_problem(), "no such file");

    // Of the arguments the function tells which.
    CHECK_FAILS(ES_ERROR_NULL, "es_scene_load, file: is null", es_scene_load(NULL, NULL, &scene));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "not UTF-8", es_scene_load("\xff\xfe", NULL, &scene));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "not UTF-8", es_scene_load("\xc0\xaf", NULL, &scene));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "not UTF-8", es_scene_load("\xed\xa0\x80", NULL, &scene));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "not UTF-8", es_scene_load("\xf4\x90\x80\x80", NULL, &scene));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "not UTF-8", es_scene_load("\xe2\x82", NULL, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "no such file", es_scene_load("\xe2\x82\xac.obj", NULL, &scene));

    // Structs tell their size.
    es_load_options options;
    CHECK_FAILS(ES_ERROR_NULL, "struct", es_load_options_init(NULL, sizeof options));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_load_options_init(&options, 3));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "struct_size", es_load_options_init(&options, sizeof options + 8));
    CHECK_OK(es_load_options_init(&options, sizeof options));
    CHECK(options.struct_size == sizeof options);
    options.struct_size = 0;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "options->struct_size", es_scene_load("a.obj", &options, &scene));
}

/// Kinds of all objects, and what befalls handles that are none.
void test_handles(void) {
    es_scene scene = make_room(0.5);
    CHECK(scene != 0);
    CHECK(es_kind_of(scene) == ES_KIND_SCENE);
    CHECK(es_kind_of(0) == ES_KIND_NONE);
    CHECK(es_kind_of(12345) == ES_KIND_NONE);

    size_t count = 0;
    CHECK_FAILS(ES_ERROR_HANDLE, "is 0", es_scene_count(0, ES_SOURCES, &count));
    CHECK_FAILS(ES_ERROR_HANDLE, "no handle", es_scene_count(12345, ES_SOURCES, &count));
    // Other bits anywhere are another handle, or none.
    for (int bit = 0; bit < 64; ++bit) {
        CHECK_FAILS(ES_ERROR_HANDLE,
                    "scene",
                    es_scene_count(scene ^ (uint64_t)1 << bit, ES_SOURCES, &count));
    }
    CHECK_FAILS(ES_ERROR_HANDLE, "is a handle of a scene", es_world_mesh_count(scene, &count));
    CHECK_FAILS(ES_ERROR_HANDLE, "give a handle of a world", es_world_mesh_count(scene, &count));

    const size_t objects = es_object_count();
    CHECK_OK(es_release(scene));
    CHECK(es_object_count() == objects - 1);
    CHECK(es_kind_of(scene) == ES_KIND_NONE);
    CHECK_FAILS(ES_ERROR_HANDLE, "was released", es_scene_count(scene, ES_SOURCES, &count));
    CHECK_FAILS(ES_ERROR_HANDLE, "was released", es_release(scene));
    CHECK_FAILS(ES_ERROR_HANDLE, "no handle", es_release(12345));
    CHECK_OK(es_release(0));

    // A place in the table that is used again does not bring old handles to life.
    for (int i = 0; i < 1000; ++i) {
        es_world world = 0;
        CHECK_OK(es_world_create(&world));
        CHECK(world != scene);
        CHECK(es_kind_of(world) == ES_KIND_WORLD);
        CHECK_FAILS(ES_ERROR_HANDLE, "was released", es_scene_count(scene, ES_SOURCES, &count));
        CHECK_OK(es_release(world));
    }
}
