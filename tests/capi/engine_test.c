// SPDX-License-Identifier: MIT
// Engines: a scene that is heard while it moves.
#include "check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { kBlock = 256, kFrames = 4096 };

static es_engine_options early_engine(void) {
    es_engine_options options;
    CHECK_OK(es_engine_options_init(&options, sizeof options));
    options.order = 1;
    options.rays = 0;
    return options;
}

static void play(es_engine engine, float* heard) {
    static float click[kFrames];
    click[0] = 1.0F;
    for (size_t n = 0; n < kFrames; n += kBlock) {
        CHECK_OK(es_engine_place_source(
            engine, 0, (const double[]){1.0 + 1e-5 * (double)n, 1.2, 1.5}, NULL));
        CHECK_OK(es_engine_publish(engine));
        CHECK_OK(es_engine_update(engine));
        CHECK_OK(es_engine_render(engine, click + n, kBlock, heard + n));
    }
}

void test_engines(void) {
    const es_scene scene = make_room(0.2);
    const es_simulation_options simulation = early_options(1);
    es_engine_options options = early_engine();
    es_engine engine = 0;
    CHECK_OK(es_engine_create(scene, &simulation, &options, &engine));
    CHECK(es_kind_of(engine) == ES_KIND_ENGINE);
    es_engine_info info = {.struct_size = sizeof info};
    CHECK_OK(es_engine_get_info(engine, &info));
    CHECK(info.sources == 1 && info.listeners == 1 && info.channels == 1 && info.block == kBlock);

    // The direct sound of a click: 1 / r after r / c.
    static float heard[kFrames], again[kFrames];
    play(engine, heard);
    const double distance = sqrt(2.5 * 2.5 + 0.5 * 0.5 + 1.0);
    const size_t arrival = info.latency + (size_t)(distance / 343.2 * 48000.0);
    float sum = 0.0F;
    for (size_t n = arrival - 20; n < arrival + 20; ++n) {
        CHECK(n > arrival - 15 || fabsf(heard[n]) < 1e-3F);
        sum += heard[n];
    }
    CHECK_NEAR(sum, 1.0 / distance, 0.02);
    es_engine_statistics statistics = {.struct_size = sizeof statistics};
    CHECK_OK(es_engine_get_statistics(engine, &statistics));
    CHECK(statistics.paths == 7 && statistics.updates == 17 && statistics.blocks == 16);

    // The same bits from another engine, by the audio thread's functions.
    es_engine other = 0;
    es_renderer* renderer = NULL;
    CHECK_OK(es_engine_create(scene, &simulation, &options, &other));
    play(other, again);
    CHECK(memcmp(heard, again, sizeof heard) == 0);
    CHECK_OK(es_engine_renderer(other, &renderer));
    CHECK_OK(es_engine_start(other));
    CHECK_FAILS(ES_ERROR_BUSY, "engine", es_engine_update(other));
    const float* in = NULL;
    float* out = again;
    es_renderer_turn(renderer, 0, (const double[]){1.0, 0.0, 0.0}, (const double[]){0.0, 1.0, 0.0});
    es_renderer_render(renderer, &in, &out, kBlock);
    CHECK_OK(es_engine_stop(other));
    CHECK_OK(es_engine_update(other));
    CHECK_OK(es_release(other));

    // What is wrong is told.
    const double place[3] = {1.0, 1.0, 1.0}, nowhere[3] = {NAN, 0.0, 0.0}, none[3] = {0};
    CHECK_FAILS(ES_ERROR_INDEX, "source", es_engine_place_source(engine, 1, place, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "position", es_engine_place_source(engine, 0, nowhere, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "position", es_engine_place_listener(engine, 0, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "front", es_engine_turn_listener(engine, 0, none, place));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_engine_set_time(engine, NAN));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "frames", es_engine_render(engine, heard, 100, again));
    CHECK_FAILS(ES_ERROR_NULL, "outputs", es_engine_render(engine, heard, kBlock, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "renderer", es_engine_renderer(engine, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "statistics", es_engine_get_statistics(engine, NULL));
    options.block = 100;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "block", es_engine_create(scene, &simulation, &options, &other));
    options = early_engine();
    options.motion_delay = -1.0;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "motion_delay", es_engine_create(scene, &simulation, &options, &other));
    CHECK_FAILS(ES_ERROR_HANDLE, "engine", es_engine_publish(scene));
    CHECK_OK(es_release(engine));
    CHECK_OK(es_release(scene));
}
