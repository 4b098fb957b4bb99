// SPDX-License-Identifier: MIT
// Simulations against image sources, simulators, options, progress.
#include "check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int ascending(const void* a, const void* b) {
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

/// Lengths of the direct sound and of six first reflections in the room of make_room().
static void image_lengths(double lengths[7]) {
    const double size[3] = {5.0, 3.0, 4.0}, source[3] = {1.0, 1.2, 1.5},
                 listener[3] = {3.5, 1.7, 2.5};
    for (int image = 0; image < 7; ++image) {
        double squared = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            double at = source[axis];
            if (image > 0 && (image - 1) / 2 == axis) {
                at = (image - 1) % 2 == 0 ? -at : 2.0 * size[axis] - at;
            }
            squared += (at - listener[axis]) * (at - listener[axis]);
        }
        lengths[image] = sqrt(squared);
    }
    qsort(lengths, 7, sizeof lengths[0], ascending);
}

static void test_paths_of_a_shoebox(void) {
    es_scene scene = make_room(0.36);
    es_simulation_options options = early_options(1);
    options.air_absorption = 0;
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK(es_kind_of(result) == ES_KIND_RESULT);
    CHECK_OK(es_release(scene));  // the result stands alone

    es_result_info info = {.struct_size = sizeof info};
    CHECK_OK(es_result_get_info(result, &info));
    CHECK(info.struct_size == sizeof info);
    CHECK(info.sources == 1 && info.listeners == 1 && info.channels == 1 && info.bands == 10);
    CHECK(info.paths == 7 && info.triangles == 12 && info.facets == 6);
    CHECK_NEAR(info.sample_rate, 48000.0, 0.0);
    CHECK_NEAR(info.speed_of_sound, 343.2, 0.05);

    double lengths[7];
    image_lengths(lengths);
    es_path_arrays arrays = {.struct_size = sizeof arrays};
    CHECK_OK(es_result_paths(result, &arrays));
    CHECK(arrays.path_count == 7 && arrays.band_count == 10);
    CHECK(arrays.first_path[0] == 0 && arrays.first_path[1] == 7);
    CHECK(arrays.point_count == 2 + 6 * 3 && arrays.interaction_count == 6);
    for (size_t i = 0; i < 7; ++i) {
        const es_path* path = &arrays.paths[i];
        CHECK(path->source == 0 && path->listener == 0);
        CHECK(path->order == (i == 0 ? 0u : 1u));
        CHECK(path->kind == (i == 0 ? ES_PATH_DIRECT : ES_PATH_SPECULAR));
        CHECK_NEAR(path->length, lengths[i], 1e-9);
        CHECK_NEAR(path->delay, lengths[i] / info.speed_of_sound, 1e-12);
        // The root of 1 - 0.36 is 0.8.
        CHECK_NEAR(arrays.pressure[10 * i + 5], (i == 0 ? 1.0 : 0.8) / lengths[i], 1e-9);
        const double* points = arrays.points + 3 * path->first_point;
        double walked = 0.0;
        for (uint32_t leg = 0; leg <= path->order; ++leg, points += 3) {
            walked += sqrt(pow(points[3] - points[0], 2) + pow(points[4] - points[1], 2) +
                           pow(points[5] - points[2], 2));
        }
        CHECK_NEAR(walked, lengths[i], 1e-9);
        CHECK_NEAR(points[0], 3.5, 0.0);  // it ends at the listener
        if (path->order == 1) {
            CHECK(arrays.triangles[path->first_interaction] < 12);
            CHECK(arrays.materials[path->first_interaction] < 6);
        }
        CHECK_NEAR(pow(path->arrival[0], 2) + pow(path->arrival[1], 2) + pow(path->arrival[2], 2),
                   1.0,
                   1e-12);
        CHECK_NEAR(
            pow(path->departure[0], 2) + pow(path->departure[1], 2) + pow(path->departure[2], 2),
            1.0,
            1e-12);
    }

    // The loudest sample is that of the direct sound.
    const float* samples = NULL;
    size_t shape[4] = {0};
    CHECK_OK(es_result_responses(result, &samples, shape));
    CHECK(shape[0] == 1 && shape[1] == 1 && shape[2] == 1 && shape[3] == info.samples);
    size_t loudest = 0;
    for (size_t n = 0; n < shape[3]; ++n) {
        loudest = fabsf(samples[n]) > fabsf(samples[loudest]) ? n : loudest;
    }
    CHECK_NEAR((double)loudest, lengths[0] / info.speed_of_sound * 48000.0, 1.0);
    CHECK_OK(es_release(result));
}

struct calls {
    int count;
    int stages;
    int stop_after;
    char last[32];
};

static int32_t count_calls(void* data, const char* stage, uint64_t done, uint64_t total) {
    struct calls* calls = data;
    CHECK(done <= total);
    if (strcmp(calls->last, stage) != 0) {
        strncpy(calls->last, stage, sizeof calls->last - 1);
        ++calls->stages;
    }
    return ++calls->count == calls->stop_after;
}

static void test_progress(void) {
    es_scene scene = make_room(0.5);
    es_simulation_options options = early_options(2);
    struct calls calls = {0, 0, 0, ""};
    options.rays = 4096;
    options.rays_error = 0.0;
    options.progress = count_calls;
    options.progress_data = &calls;
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK(calls.stages == 3);  // tracing, late rays, responses
    CHECK_TEXT(calls.last, "responses");
    CHECK_OK(es_release(result));
    const int all = calls.count;

    // Stopped at any step, the call fails, and the simulator serves again.
    es_simulator simulator = 0;
    CHECK_OK(es_simulator_create(scene, &options, &simulator));
    for (int stop_after = 1; stop_after <= all; ++stop_after) {
        calls = (struct calls){0, 0, stop_after, ""};
        result = 7;
        CHECK_FAILS(ES_ERROR_CANCELLED, "cancelled", es_simulate(scene, &options, &result));
        CHECK(calls.count == stop_after);
        CHECK(result == 7);
        calls = (struct calls){0, 0, stop_after, ""};
        CHECK_FAILS(ES_ERROR_CANCELLED, "cancelled", es_simulator_run(simulator, 0.0, &result));
    }
    calls = (struct calls){0, 0, 0, ""};
    CHECK_OK(es_simulator_run(simulator, 0.0, &result));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(simulator));
    CHECK_OK(es_release(scene));
}

/// Whether two results have the same samples.
static int same_samples(es_result a, es_result b) {
    const float *x = NULL, *y = NULL;
    size_t of_x[4], of_y[4];
    CHECK_OK(es_result_responses(a, &x, of_x));
    CHECK_OK(es_result_responses(b, &y, of_y));
    return memcmp(of_x, of_y, sizeof of_x) == 0 &&
           memcmp(x, y, of_x[0] * of_x[1] * of_x[2] * of_x[3] * sizeof *x) == 0;
}

static void test_simulator(void) {
    es_scene scene = make_room(0.5);
    const double second[3] = {2.5, 1.0, 3.0}, moved[3] = {4.0, 1.0, 1.0},
                 target[3] = {1.0, 1.0, 1.0};
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, second, NULL, 1, NULL));
    es_simulation_options options = early_options(2);
    options.format = ES_FORMAT_AMBISONIC;
    options.metrics = 0;
    options.keep_traces = 1;
    es_simulator simulator = 0;
    es_result kept = 0, fresh = 0;
    CHECK_OK(es_simulator_create(scene, &options, &simulator));
    CHECK(es_kind_of(simulator) == ES_KIND_SIMULATOR);
    for (int run = 0; run < 3; ++run) {
        if (run == 1) {
            CHECK_OK(es_scene_set_position(scene, ES_LISTENERS, 1, moved));
            CHECK_OK(es_simulator_set_position(simulator, ES_LISTENERS, 1, moved));
        } else if (run == 2) {
            CHECK_OK(es_scene_set_look_at(scene, ES_LISTENERS, ES_ALL, target));
            CHECK_OK(es_simulator_set_look_at(simulator, ES_LISTENERS, ES_ALL, target));
        }
        CHECK_OK(es_simulator_run(simulator, 0.0, &kept));
        CHECK_OK(es_simulate(scene, &options, &fresh));
        CHECK(same_samples(kept, fresh));
        CHECK_OK(es_release(kept));
        CHECK_OK(es_release(fresh));
    }
    CHECK_FAILS(ES_ERROR_NULL, "simulator", es_simulator_create(scene, &options, NULL));
    CHECK_OK(es_release(scene));  // it has a copy
    CHECK_OK(es_simulator_run(simulator, 0.0, &kept));
    CHECK_OK(es_release(kept));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_simulator_run(simulator, NAN, &kept));
    CHECK_FAILS(ES_ERROR_NULL, "result", es_simulator_run(simulator, 0.0, NULL));
    CHECK_FAILS(
        ES_ERROR_INDEX, "index", es_simulator_set_position(simulator, ES_SOURCES, 1, moved));
    CHECK_FAILS(
        ES_ERROR_NULL, "position", es_simulator_set_position(simulator, ES_SOURCES, 0, NULL));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "item", es_simulator_set_position(simulator, ES_MESHES, 0, moved));
    CHECK_FAILS(
        ES_ERROR_INDEX, "index", es_simulator_set_look_at(simulator, ES_SOURCES, 1, target));
    CHECK_OK(es_release(simulator));
}

/// Of a scene that moves, the instant counts.
/// Whether two results have the same T30 and C50 of all bands.
static int same_metrics(es_result a, es_result b) {
    const int32_t metrics[] = {ES_METRIC_T30, ES_METRIC_C50};
    for (int i = 0; i < 2; ++i) {
        const double *x = NULL, *y = NULL;
        size_t shape[3];
        CHECK_OK(es_result_metric(a, metrics[i], ES_EXPECTED, ES_PER_BAND, &x, NULL, shape));
        CHECK_OK(es_result_metric(b, metrics[i], ES_EXPECTED, ES_PER_BAND, &y, NULL, shape));
        if (memcmp(x, y, shape[0] * shape[1] * shape[2] * sizeof *x) != 0) {
            return 0;
        }
    }
    return 1;
}

// Responses and metrics are the same without the paths, in a box answered by its lattice and where
// a directed source needs the paths.
static void test_without_paths(void) {
    es_scene scene = make_room(0.3);
    for (int directed = 0; directed < 2; ++directed) {
        es_simulation_options options = early_options(5);
        options.rays = 500;
        options.rays_error = 0.0;
        es_result with = 0, without = 0;
        CHECK_OK(es_simulate(scene, &options, &with));
        options.paths = 0;
        CHECK_OK(es_simulate(scene, &options, &without));
        CHECK(same_samples(with, without) && same_metrics(with, without));

        es_result_info info = {.struct_size = sizeof info};
        es_path_arrays arrays = {.struct_size = sizeof arrays};
        CHECK_OK(es_result_get_info(without, &info));
        CHECK(info.paths == 0);
        CHECK_FAILS(ES_ERROR_FAILED, "options::paths", es_result_paths(without, &arrays));
        CHECK_FAILS(ES_ERROR_FAILED,
                    "options::paths",
                    es_result_write(without, ES_PATHS_JSON, "paths.json"));
        es_messages notes = 0;
        size_t count = 0;
        CHECK_OK(es_result_notes(without, &notes));
        CHECK_OK(es_messages_count(notes, &count));
        for (size_t i = 0; i < count; ++i) {
            const char *subject = NULL, *text = NULL;
            CHECK_OK(es_messages_get(notes, i, &subject, &text));
            CHECK(strstr(text, "silent") == NULL);
        }
        CHECK_OK(es_release(notes));
        CHECK_OK(es_release(with));
        CHECK_OK(es_release(without));
        CHECK_OK(es_scene_set_directivity(scene, 0, "cardioid"));
    }
    CHECK_OK(es_release(scene));
}

/// How far a point lies from the straight line between two others, over its length.
static double detour(const double* from, const double* over, const double* to) {
    double legs[3] = {0.0, 0.0, 0.0};
    for (int axis = 0; axis < 3; ++axis) {
        legs[0] += pow(over[axis] - from[axis], 2);
        legs[1] += pow(to[axis] - over[axis], 2);
        legs[2] += pow(to[axis] - from[axis], 2);
    }
    return sqrt(legs[0]) + sqrt(legs[1]) - sqrt(legs[2]);
}

/// Round the inner corner of an L, which hides some listener.
static void test_diffraction(void) {
    es_scene scene = 0;
    CHECK_OK(es_scene_load(project_file("scenes/lroom.gltf"), NULL, &scene));
    es_simulation_options options = early_options(1);
    options.metrics = 0;
    es_result without = 0, with = 0;
    CHECK_OK(es_simulate(scene, &options, &without));
    options.diffraction = 1;
    CHECK_OK(es_simulate(scene, &options, &with));

    es_path_arrays arrays = {.struct_size = sizeof arrays},
                   specular = {.struct_size = sizeof arrays};
    CHECK_OK(es_result_paths(without, &specular));
    CHECK(specular.edge_count == 0 && specular.first_edge[specular.path_count] == 0);
    CHECK_OK(es_result_paths(with, &arrays));
    size_t diffracted = 0;
    for (size_t i = 0; i < arrays.path_count; ++i) {
        const es_path* path = &arrays.paths[i];
        const size_t edges = arrays.first_edge[i + 1] - arrays.first_edge[i];
        CHECK(edges == (path->kind == ES_PATH_DIFFRACTED ? 1u : 0u));
        if (edges == 0) {
            continue;
        }
        ++diffracted;
        CHECK(path->order == 1 || path->order == 2);
        // One of its points lies on the edge.
        const double* edge = arrays.edges + 6 * arrays.first_edge[i];
        double closest = INFINITY;
        for (uint32_t point = 1; point <= path->order; ++point) {
            const double* at = arrays.points + 3 * (path->first_point + point);
            closest = fmin(closest, detour(edge, at, edge + 3));
        }
        CHECK(closest < 1e-9);
    }
    CHECK(diffracted > 0 && diffracted == arrays.edge_count);
    CHECK(arrays.path_count == specular.path_count + diffracted);

    // Without diffraction one note tells of the pairs without a direct path.
    const es_result results[2] = {without, with};
    for (size_t i = 0; i < 2; ++i) {
        es_messages notes = 0;
        size_t count = 0, told = 0;
        CHECK_OK(es_result_notes(results[i], &notes));
        CHECK_OK(es_messages_count(notes, &count));
        for (size_t k = 0; k < count; ++k) {
            const char *subject = NULL, *text = NULL;
            CHECK_OK(es_messages_get(notes, k, &subject, &text));
            told += strstr(text, "no direct path") != NULL ? 1 : 0;
        }
        CHECK(told == (i == 0 ? 1u : 0u));
        CHECK_OK(es_release(notes));
        CHECK_OK(es_release(results[i]));
    }
    CHECK_OK(es_release(scene));
}

static void test_time(void) {
    es_scene scene = 0;
    CHECK_OK(es_scene_load(project_file("scenes/door.gltf"), NULL, &scene));
    es_simulation_options options = early_options(2);
    options.metrics = 0;
    options.time = 2.0;
    es_simulator simulator = 0;
    es_result shut = 0, open = 0, again = 0;
    CHECK_OK(es_simulator_create(scene, &options, &simulator));
    CHECK_OK(es_simulator_run(simulator, 0.0, &shut));
    CHECK_OK(es_simulator_run(simulator, 2.0, &open));
    CHECK_OK(es_simulate(scene, &options, &again));
    CHECK(!same_samples(shut, open));
    CHECK(same_samples(open, again));
    CHECK_OK(es_release(shut));
    CHECK_OK(es_release(open));
    CHECK_OK(es_release(again));
    CHECK_OK(es_release(simulator));
    CHECK_OK(es_release(scene));
}

void test_simulation(void) {
    test_paths_of_a_shoebox();
    test_progress();
    test_simulator();
    test_without_paths();
    test_diffraction();
    test_time();
    // The scene of a call that failed for want of a pointer.
    es_result result = 0;
    CHECK_FAILS(ES_ERROR_HANDLE, "scene", es_simulate(0, NULL, &result));
}

#define WRONG(member, value, status, text)                                          \
    do {                                                                            \
        es_simulation_options wrong = options;                                      \
        wrong.member = (value);                                                     \
        CHECK_FAILS((status), (text), es_simulate(scene, &wrong, &result));         \
        CHECK_FAILS((status), (text), es_simulator_create(scene, &wrong, &result)); \
    } while (0)

void test_simulation_options(void) {
    es_scene scene = make_room(0.5);
    es_simulation_options options;
    uint64_t result = 0;
    CHECK_OK(es_simulation_options_init(&options, sizeof options));
    CHECK(options.order == 4 && options.rays == 1000000 && options.seed == 1 &&
          options.metrics == 1);
    CHECK_NEAR(options.rays_error, 0.02, 0.0);
    CHECK(isinf(options.min_level_db) && options.min_level_db < 0.0);
    CHECK_FAILS(ES_ERROR_NULL, "struct", es_simulation_options_init(NULL, sizeof options));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_simulation_options_init(&options, 100));

    options = early_options(1);
    WRONG(struct_size, 0, ES_ERROR_ARGUMENT, "struct_size");
    WRONG(struct_size, sizeof options + 1, ES_ERROR_ARGUMENT, "struct_size");
    WRONG(time, NAN, ES_ERROR_ARGUMENT, "options->time");
    WRONG(order, -1, ES_ERROR_ARGUMENT, "options->order");
    WRONG(order, 65, ES_ERROR_ARGUMENT, "options->order");
    WRONG(diffraction, -1, ES_ERROR_ARGUMENT, "options->diffraction");
    WRONG(diffraction, 3, ES_ERROR_ARGUMENT, "options->diffraction");
    WRONG(mode, 2, ES_ERROR_ARGUMENT, "options->mode");
    WRONG(resolution, 1025, ES_ERROR_ARGUMENT, "options->resolution");
    WRONG(transmission, 2, ES_ERROR_ARGUMENT, "options->transmission");
    WRONG(max_length, -1.0, ES_ERROR_ARGUMENT, "options->max_length");
    WRONG(max_length, NAN, ES_ERROR_ARGUMENT, "options->max_length");
    WRONG(min_level_db, INFINITY, ES_ERROR_ARGUMENT, "options->min_level_db");
    WRONG(min_diffraction_level_db, NAN, ES_ERROR_ARGUMENT, "options->min_diffraction_level_db");
    WRONG(rays, 1000000001, ES_ERROR_ARGUMENT, "options->rays");
    WRONG(rays_error, 1.5, ES_ERROR_ARGUMENT, "options->rays_error");
    WRONG(rays_error, NAN, ES_ERROR_ARGUMENT, "options->rays_error");
    WRONG(seed, UINT64_MAX, ES_ERROR_ARGUMENT, "options->seed");
    WRONG(temperature_c, 71.0, ES_ERROR_ARGUMENT, "options->temperature_c");
    WRONG(humidity_percent, -1.0, ES_ERROR_ARGUMENT, "options->humidity_percent");
    WRONG(pressure_kpa, 0.0, ES_ERROR_ARGUMENT, "options->pressure_kpa");
    WRONG(air_absorption, -1, ES_ERROR_ARGUMENT, "options->air_absorption");
    WRONG(bands, 2, ES_ERROR_ARGUMENT, "options->bands");
    WRONG(format, 3, ES_ERROR_ARGUMENT, "options->format");
    WRONG(ambisonic_order, 6, ES_ERROR_ARGUMENT, "options->ambisonic_order");
    WRONG(sample_rate, 999.0, ES_ERROR_ARGUMENT, "options->sample_rate");
    WRONG(sample_rate, NAN, ES_ERROR_ARGUMENT, "options->sample_rate");
    WRONG(length, 3601.0, ES_ERROR_ARGUMENT, "options->length");
    WRONG(hrtf_raw, 2, ES_ERROR_ARGUMENT, "options->hrtf_raw");
    WRONG(hrtf_file, "\xff", ES_ERROR_ARGUMENT, "options->hrtf_file");
    WRONG(responses, 2, ES_ERROR_ARGUMENT, "options->responses");
    WRONG(metrics, 2, ES_ERROR_ARGUMENT, "options->metrics");
    WRONG(histograms, 2, ES_ERROR_ARGUMENT, "options->histograms");
    WRONG(keep_traces, 2, ES_ERROR_ARGUMENT, "options->keep_traces");
    WRONG(sofa, 2, ES_ERROR_ARGUMENT, "options->sofa");
    WRONG(paths, 2, ES_ERROR_ARGUMENT, "options->paths");
    WRONG(speech, 2, ES_ERROR_ARGUMENT, "options->speech");
    WRONG(speech_level_db, 201.0, ES_ERROR_ARGUMENT, "options->speech_level_db");
    const double noise[7] = {0, 0, 0, NAN, 0, 0, 0};
    WRONG(noise_db, noise, ES_ERROR_ARGUMENT, "options->noise_db");
    WRONG(visible_sets, scene, ES_ERROR_HANDLE, "options->visible_sets");
    WRONG(threads, -1, ES_ERROR_ARGUMENT, "options->threads");
    CHECK_FAILS(ES_ERROR_NULL, "result", es_simulate(scene, &options, NULL));
    options.format = ES_FORMAT_BINAURAL;
    WRONG(hrtf_file, "none.sofa", ES_ERROR_FAILED, "none.sofa");

    // Speech in a noisy room is understood less.
    double levels[7];
    CHECK_OK(es_noise_criterion(30.0, levels));
    CHECK(levels[0] > levels[6] && levels[6] > 20.0);
    CHECK_FAILS(ES_ERROR_ARGUMENT, "number", es_noise_criterion(14.0, levels));
    CHECK_FAILS(ES_ERROR_NULL, "levels_db", es_noise_criterion(30.0, NULL));
    double sti[2];
    for (int noisy = 0; noisy < 2; ++noisy) {
        options = early_options(2);
        options.rays = 20000;
        options.rays_error = 0.0;
        CHECK_OK(es_noise_criterion(60.0, levels));
        options.speech = noisy;
        options.noise_db = levels;
        const double* values = NULL;
        size_t shape[3];
        CHECK_OK(es_simulate(scene, &options, &result));
        CHECK_OK(es_result_metric(
            result, ES_METRIC_STI, ES_EXPECTED, ES_SINGLE_NUMBER, &values, NULL, shape));
        sti[noisy] = values[0];
        CHECK_OK(es_release(result));
    }
    CHECK(sti[1] < sti[0] - 0.1);

    // Without sources or listeners there is nothing to simulate.
    CHECK_OK(es_scene_remove(scene, ES_LISTENERS, ES_ALL));
    CHECK_FAILS(ES_ERROR_FAILED, "no listener", es_simulate(scene, NULL, &result));
    CHECK_OK(es_scene_remove(scene, ES_SOURCES, ES_ALL));
    CHECK_FAILS(ES_ERROR_FAILED, "no source", es_simulate(scene, NULL, &result));
    CHECK_FAILS(ES_ERROR_FAILED, "no source", es_simulator_create(scene, NULL, &result));
    CHECK_OK(es_release(scene));
}

/// Run with a library that stands alone: only what reads or writes SOFA files fails.
void test_without_module(void) {
    es_scene scene = make_room(0.5);
    es_simulation_options options = early_options(1);
    es_result result = 0;
    options.metrics = 0;
    options.sofa = 1;
    CHECK_OK(es_simulate(scene, &options, &result));
    CHECK_FAILS(ES_ERROR_FAILED,
                "libearshot-sofa.so beside",
                es_results_write_sofa(&result, 1, "responses.sofa"));
    CHECK_TEXT(es_error_subject(), "responses.sofa");
    CHECK_OK(es_release(result));
    options.format = ES_FORMAT_BINAURAL;
    options.hrtf_file = "any.sofa";
    CHECK_FAILS(
        ES_ERROR_FAILED, "libearshot-sofa.so beside", es_simulate(scene, &options, &result));
    CHECK_TEXT(es_error_subject(), "any.sofa");
    CHECK_OK(es_release(scene));
}
