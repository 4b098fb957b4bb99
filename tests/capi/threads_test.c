// SPDX-License-Identifier: MIT
// Several threads, and callbacks that call the library.
#include "check.h"
#include <pthread.h>
#include <string.h>

static es_scene shared_scene;
static es_simulator shared_simulator;

/// While a simulation reads the scene: who reads may, who would change it is told.
static int32_t use_while_busy(void* data, const char* stage, uint64_t done, uint64_t total) {
    size_t count = 0;
    es_result result = 0;
    const double point[3] = {1, 1, 1};
    (void)stage, (void)done, (void)total;
    CHECK_OK(es_scene_count(shared_scene, ES_SOURCES, &count));
    if (shared_simulator != 0) {
        CHECK_FAILS(ES_ERROR_BUSY,
                    "another call is using",
                    es_simulator_run(shared_simulator, 0.0, &result));
        CHECK_FAILS(ES_ERROR_BUSY,
                    "simulator",
                    es_simulator_set_position(shared_simulator, ES_SOURCES, 0, point));
    } else {
        CHECK_FAILS(
            ES_ERROR_BUSY, "scene", es_scene_set_position(shared_scene, ES_SOURCES, 0, point));
        CHECK_FAILS(ES_ERROR_BUSY, "scene", es_scene_remove(shared_scene, ES_SOURCES, ES_ALL));
    }
    ++*(int*)data;
    return 0;
}

static void test_busy_objects(void) {
    int calls = 0;
    es_result result = 0;
    es_simulation_options options = early_options(1);
    options.threads = 1;
    options.progress = use_while_busy;
    options.progress_data = &calls;
    shared_scene = make_room(0.5);
    shared_simulator = 0;
    CHECK_OK(es_simulate(shared_scene, &options, &result));
    CHECK(calls > 0);
    CHECK_OK(es_release(result));
    calls = 0;
    es_simulator simulator = 0;
    CHECK_OK(es_simulator_create(shared_scene, &options, &simulator));
    shared_simulator = simulator;
    CHECK_OK(es_simulator_run(simulator, 0.0, &result));
    CHECK(calls > 0);
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(simulator));
    // Changed again, now that nobody uses it.
    CHECK_OK(es_scene_remove(shared_scene, ES_SOURCES, ES_ALL));
    CHECK_OK(es_release(shared_scene));
}

/// What is released while it is in use ends with the call.
static int32_t release_scene(void* data, const char* stage, uint64_t done, uint64_t total) {
    (void)stage, (void)done, (void)total;
    es_scene* scene = data;
    if (*scene != 0) {
        CHECK_OK(es_release(*scene));
        CHECK(es_kind_of(*scene) == ES_KIND_NONE);
        *scene = 0;
    }
    return 0;
}

static void test_release_in_use(void) {
    es_scene scene = make_room(0.5);
    es_result result = 0;
    es_simulation_options options = early_options(2);
    options.progress = release_scene;
    options.progress_data = &scene;
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK(scene == 0);
    CHECK_OK(es_release(result));
}

struct work {
    es_scene scene;
    int thread;
    float sample;
};

/// Each thread simulates the same scene and makes mistakes of its own.
static void* work(void* data) {
    struct work* mine = data;
    CHECK(es_error_status() == ES_OK);  // of this thread nothing has failed
    for (int i = 0; i < 20; ++i) {
        es_simulation_options options = early_options(2);
        options.threads = 1;
        options.metrics = 0;
        es_result result = 0;
        CHECK_OK(es_simulate(mine->scene, &options, &result));
        const float* samples = NULL;
        size_t shape[4];
        CHECK_OK(es_result_responses(result, &samples, shape));
        float largest = 0.0f;
        for (size_t n = 0; n < shape[3]; ++n) {
            largest = samples[n] > largest ? samples[n] : largest;
        }
        CHECK(i == 0 || largest == mine->sample);
        mine->sample = largest;
        CHECK_OK(es_release(result));

        char name[16] = "file0.obj";
        name[4] = (char)('0' + mine->thread);
        es_scene none = 0;
        CHECK_FAILS(ES_ERROR_FAILED, name, es_scene_load(name, NULL, &none));
        es_world world = 0;
        CHECK_OK(es_world_create(&world));
        CHECK_TEXT(es_error_subject(), name);
        CHECK_OK(es_release(world));
    }
    return NULL;
}

static void test_many_threads(void) {
    enum { kThreads = 4 };
    es_scene scene = make_room(0.5);
    pthread_t threads[kThreads];
    struct work works[kThreads];
    for (int i = 0; i < kThreads; ++i) {
        works[i] = (struct work){scene, i, 0.0f};
        CHECK(pthread_create(&threads[i], NULL, work, &works[i]) == 0);
    }
    for (int i = 0; i < kThreads; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0);
        CHECK(works[i].sample == works[0].sample);
    }
    CHECK_OK(es_release(scene));
}

void test_threads(void) {
    test_busy_objects();
    test_release_in_use();
    test_many_threads();
}
