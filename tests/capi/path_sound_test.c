// SPDX-License-Identifier: MIT
// Recordings played over paths that have been found already.
#include "check.h"
#include <math.h>
#include <stdio.h>

enum { RATE = 8000, FRAMES = 4000, COUNT = 11 };

static const double kSize[] = {60.0, 10.0, 10.0}, kListener[] = {1.0, 5.0, 5.0};
static const double kStart[] = {55.0, 5.0, 5.0};

static es_scene make_hall(void) {
    es_scene scene = 0;
    CHECK_OK(es_scene_create_shoebox(kSize, &scene));
    CHECK_OK(es_scene_add(scene, ES_SOURCES, kStart, NULL, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, kListener, NULL, 1, NULL));
    return scene;
}

static es_sound make_tone(size_t channels) {
    double tone[FRAMES];
    for (int n = 0; n < FRAMES; ++n) {
        tone[n] = sin(2.0 * 3.141592653589793 * 900.0 * n / RATE);
    }
    es_sound sound = 0;
    CHECK_OK(es_sound_create(tone, FRAMES / channels, channels, RATE, &sound));
    return sound;
}

// A source that comes nearer at 34.32 m/s, a tenth of the speed of sound.
static void find_paths(int32_t bands, es_result results[COUNT]) {
    const es_scene scene = make_hall();
    es_simulation_options options = early_options(0);
    options.responses = 0;
    options.metrics = 0;
    options.air_absorption = 0;
    options.bands = bands;
    es_simulator simulator = 0;
    CHECK_OK(es_simulator_create(scene, &options, &simulator));
    for (int k = 0; k < COUNT; ++k) {
        const double time = 0.1 * k;
        const double place[] = {kStart[0] - 34.32 * time, kStart[1], kStart[2]};
        CHECK_OK(es_simulator_set_position(simulator, ES_SOURCES, 0, place));
        CHECK_OK(es_simulator_run(simulator, time, &results[k]));
    }
    CHECK_OK(es_release(simulator));
    CHECK_OK(es_release(scene));
}

static void release_all(const es_result results[COUNT]) {
    for (int k = 0; k < COUNT; ++k) {
        CHECK_OK(es_release(results[k]));
    }
}

// The tone of 900 Hz is heard at 1000 Hz, from the listener's right: +X where it looks along -Z.
static void check_heard(es_sound wet) {
    const double* samples = NULL;
    size_t frames = 0, channels = 0, crossings = 0;
    CHECK_OK(es_sound_samples(wet, &samples, &frames, &channels, NULL));
    CHECK(channels == 4 && frames >= FRAMES);
    for (size_t n = 2000; n < 4000; ++n) {
        const double* heard = samples + 4 * n;
        crossings += heard[0] < 0.0 && heard[4] >= 0.0 ? 1 : 0;
        CHECK_NEAR(heard[1], -heard[0], 1e-9);
        CHECK_NEAR(heard[2], 0.0, 1e-9);
        CHECK_NEAR(heard[3], 0.0, 1e-9);
    }
    CHECK(crossings >= 249 && crossings <= 251);
    CHECK_OK(es_release(wet));
}

static void test_results_over_time(void) {
    es_result results[COUNT], thirds[COUNT];
    find_paths(ES_BANDS_OCTAVE, results);
    find_paths(ES_BANDS_THIRD, thirds);
    const es_sound dry = make_tone(1), stereo = make_tone(2);
    es_simulation_options options = early_options(0);
    options.format = ES_FORMAT_AMBISONIC;
    es_sound wet = 0;
    CHECK_OK(es_auralize_results(results, COUNT, 0, 0, dry, &options, &wet));
    check_heard(wet);
    CHECK_OK(es_auralize_results(results, COUNT, 0, 0, dry, NULL, &wet));
    const double* samples = NULL;
    size_t frames = 0, channels = 0;
    CHECK_OK(es_sound_samples(wet, &samples, &frames, &channels, NULL));
    CHECK(channels == 1);
    CHECK_OK(es_release(wet));

    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "count", es_auralize_results(results, 1, 0, 0, dry, &options, &wet));
    CHECK_FAILS(
        ES_ERROR_NULL, "results", es_auralize_results(NULL, COUNT, 0, 0, dry, &options, &wet));
    CHECK_FAILS(
        ES_ERROR_INDEX, "source", es_auralize_results(results, COUNT, 1, 0, dry, &options, &wet));
    CHECK_FAILS(ES_ERROR_INDEX,
                "listener",
                es_auralize_results(results, COUNT, 0, ES_NONE, dry, &options, &wet));
    CHECK_FAILS(
        ES_ERROR_HANDLE, "dry", es_auralize_results(results, COUNT, 0, 0, 0, &options, &wet));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "dry",
                es_auralize_results(results, COUNT, 0, 0, stereo, &options, &wet));
    CHECK_FAILS(
        ES_ERROR_NULL, "wet", es_auralize_results(results, COUNT, 0, 0, dry, &options, NULL));
    options.format = 9;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "options->format",
                es_auralize_results(results, COUNT, 0, 0, dry, &options, &wet));
    const es_result twice[] = {results[3], results[3]}, mixed[] = {results[0], thirds[1]};
    const es_result unknown[] = {results[0], dry};
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "is not later", es_auralize_results(twice, 2, 0, 0, dry, NULL, &wet));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "bands", es_auralize_results(mixed, 2, 0, 0, dry, NULL, &wet));
    CHECK_FAILS(
        ES_ERROR_HANDLE, "results[1]", es_auralize_results(unknown, 2, 0, 0, dry, NULL, &wet));
    CHECK_OK(es_release(stereo));
    CHECK_OK(es_release(dry));
    release_all(results);
    release_all(thirds);
}

// A source at 3.4 m, of which sound takes 0.01 s: 80 samples.
static void write_paths(const char* name, int instants) {
    FILE* file = fopen(name, "w");
    CHECK(file != NULL);
    fprintf(file,
            "{\"speed_of_sound\":340,\"bands_hz\":[31.5,63,125,250,500,1000,2000,4000,8000,16000],"
            "\"pairs\":[");
    for (int k = 0; k < instants; ++k) {
        fprintf(
            file,
            "%s{\"source\":\"s\",\"listener\":\"l\",\"time\":%d,\"paths\":[{\"kind\":\"direct\","
            "\"points\":[[3.4,0,0],[0,0,0]],\"triangles\":[],\"pressure\":[",
            k > 0 ? "," : "",
            k);
        for (int band = 0; band < 10; ++band) {
            fprintf(file, "%s%.17g", band > 0 ? "," : "", 1.0 / 3.4);
        }
        fprintf(file, "]}]}");
    }
    fprintf(file, "]}");
    CHECK(fclose(file) == 0);
}

static void test_files_of_paths(void) {
    const double click[] = {1.0};
    es_sound dry = 0, wet = 0;
    CHECK_OK(es_sound_create(click, 1, 1, RATE, &dry));
    write_paths("paths.json", 2);
    write_paths("one.json", 1);
    CHECK_OK(es_auralize_paths("paths.json", "s", NULL, dry, NULL, &wet));
    const double* samples = NULL;
    size_t frames = 0, channels = 0;
    CHECK_OK(es_sound_samples(wet, &samples, &frames, &channels, NULL));
    CHECK(channels == 1 && frames > 80);
    for (size_t n = 0; n < frames; ++n) {
        CHECK_NEAR(samples[n], n == 80 ? 1.0 / 3.4 : 0.0, 1e-4);
    }
    CHECK_OK(es_release(wet));

    CHECK_FAILS(ES_ERROR_FAILED,
                "one instant alone",
                es_auralize_paths("one.json", NULL, NULL, dry, NULL, &wet));
    CHECK_FAILS(ES_ERROR_FAILED,
                "no such source",
                es_auralize_paths("paths.json", "nobody", NULL, dry, NULL, &wet));
    CHECK_FAILS(ES_ERROR_FAILED,
                "no such listener",
                es_auralize_paths("paths.json", "s", "nobody", dry, NULL, &wet));
    CHECK_FAILS(ES_ERROR_NULL, "paths", es_auralize_paths(NULL, NULL, NULL, dry, NULL, &wet));
    CHECK_FAILS(
        ES_ERROR_FAILED, "none.json", es_auralize_paths("none.json", NULL, NULL, dry, NULL, &wet));
    CHECK_FAILS(ES_ERROR_NULL, "wet", es_auralize_paths("paths.json", NULL, NULL, dry, NULL, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "dry", es_auralize_paths("paths.json", NULL, NULL, 0, NULL, &wet));
    CHECK_OK(es_release(dry));
}

void test_path_sounds(void) {
    test_results_over_time();
    test_files_of_paths();
}
