// SPDX-License-Identifier: MIT
// What results tell: metrics, rooms, histograms, documents.
#include "check.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static es_result simulate(es_scene scene, int32_t format, int32_t has_all) {
    es_simulation_options options = early_options(3);
    options.rays = 20000;
    options.rays_error = 0.0;
    options.format = format;
    options.histograms = has_all;
    options.metrics = has_all;
    options.responses = has_all;
    options.sensitivity = has_all;
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &options, &result));
    return result;
}

static double metric(es_result result, int32_t which, int32_t set, int32_t form, size_t index) {
    const double *values = NULL, *errors = NULL;
    size_t shape[3] = {0};
    CHECK_OK(es_result_metric(result, which, set, form, &values, &errors, shape));
    CHECK(shape[0] == 1 && shape[1] == 2 && shape[2] == (form == ES_PER_BAND ? 10u : 1u));
    CHECK(index < shape[0] * shape[1] * shape[2]);
    CHECK(errors != NULL);
    return values[index];
}

/// A room whose walls scatter all sound is diffuse: T30 is near Eyring's time.
static void test_diffuse_room(void) {
    es_scene scene = make_room(0.2);
    const double one = 0.2, all = 1.0, second[3] = {2.0, 1.0, 3.0};
    es_material material;
    CHECK_OK(es_material_init(&material, sizeof material));
    material.absorption = &one;
    material.scattering = &all;
    CHECK_OK(es_scene_assign(scene, "*", &material, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, second, NULL, 1, NULL));
    es_result result = simulate(scene, ES_FORMAT_MONO, 1);

    // 60 m3, 94 m2: of Eyring, without air, 0.161 * 60 / (94 * 0.2231) = 0.461 s at most.
    es_room room = {.struct_size = sizeof room};
    CHECK_OK(es_result_room(result, &room));
    CHECK(room.is_enclosed == 1 && room.band_count == 10);
    CHECK_NEAR(room.volume, 60.0, 3.0);
    CHECK_NEAR(room.surface, 94.0, 3.0);
    CHECK_NEAR(room.opening, 0.0, 0.0);
    CHECK_NEAR(room.absorption[5], 0.2, 0.005);
    CHECK_NEAR(room.eyring[2], 0.461, 0.025);
    CHECK(room.sabine[2] > room.eyring[2]);
    CHECK_NEAR(metric(result, ES_METRIC_T30, ES_RESPONSE, ES_SINGLE_NUMBER, 0) / room.eyring[5],
               1.0,
               0.15);

    // The mean of 500 Hz and 1 kHz.
    CHECK_NEAR(metric(result, ES_METRIC_TS, ES_EXPECTED, ES_SINGLE_NUMBER, 1),
               0.5 * (metric(result, ES_METRIC_TS, ES_EXPECTED, ES_PER_BAND, 14) +
                      metric(result, ES_METRIC_TS, ES_EXPECTED, ES_PER_BAND, 15)),
               1e-12);
    CHECK(metric(result, ES_METRIC_STI, ES_EXPECTED, ES_SINGLE_NUMBER, 0) > 0.5);
    CHECK(metric(result, ES_METRIC_SCHROEDER, ES_EXPECTED, ES_SINGLE_NUMBER, 0) > 50.0);

    const char* text = NULL;
    CHECK_OK(es_result_metric_note(result, ES_METRIC_TS, ES_EXPECTED, 0, 0, 5, &text));
    CHECK_TEXT(text, "");  // it has a value

    // Late energy: all entries are finite, none negative; their sum is that of the late sound.
    es_histogram histogram = {.struct_size = sizeof histogram};
    CHECK_OK(es_result_histogram(result, 0, 1, &histogram));
    CHECK(histogram.bin_count > 100 && histogram.band_count == 10 && histogram.rays == 20000);
    CHECK_NEAR(histogram.bin, 1e-3, 0.0);
    CHECK(histogram.is_full_decay == 1 && histogram.error_reached == 1);
    double sum = 0.0;
    for (size_t i = 0; i < histogram.bin_count * histogram.band_count; ++i) {
        CHECK(histogram.energy[i] >= 0.0 && histogram.error[i] >= 0.0);
        sum += histogram.energy[i];
    }
    CHECK(sum > 0.0);

    const double* hz = NULL;
    size_t count = 0;
    CHECK_OK(es_result_bands(result, &hz, &count));
    CHECK(count == 10);
    CHECK_NEAR(hz[5], 1000.0, 0.0);
    es_messages notes = 0;
    CHECK_OK(es_result_notes(result, &notes));
    CHECK_OK(es_release(notes));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}

/// All sound of a closed room is absorbed, and more absorption makes its decay shorter.
static void test_sensitivity(void) {
    es_scene scene = make_room(0.2);
    es_result result = simulate(scene, ES_FORMAT_MONO, 1);
    es_sensitivity sensitivity = {.struct_size = sizeof sensitivity};
    CHECK_OK(es_result_sensitivity(result, &sensitivity));
    const size_t materials = sensitivity.material_count, bands = sensitivity.band_count;
    CHECK(materials > 0 && bands == 10);
    const double *t30 = NULL, *errors = NULL, *sti = NULL;
    size_t shape[4] = {0};
    CHECK_OK(es_result_derivative(result, ES_METRIC_T30, ES_SINGLE_NUMBER, &t30, &errors, shape));
    CHECK(shape[0] == 1 && shape[1] == 1 && shape[2] == materials && shape[3] == 1);
    CHECK_OK(es_result_derivative(result, ES_METRIC_STI, ES_PER_BAND, &sti, NULL, shape));
    CHECK(shape[3] == bands);
    double absorbed = 0.0, area = 0.0;
    for (size_t i = 0; i < materials; ++i) {
        const size_t at = i * bands + 4;
        area += sensitivity.areas[i];
        absorbed += sensitivity.absorbed_before[at] + sensitivity.absorbed_after[at];
        CHECK(sensitivity.touched_before[at] > 0.0 && sensitivity.touched_before[at] < 1.0);
        CHECK(sensitivity.touched_after[at] <= 1.0 + 1e-12);
        CHECK(sensitivity.reflections_after[at] > sensitivity.reflections_before[at]);
        CHECK(t30[i] < 0.0 && errors[i] > 0.0 && errors[i] < -t30[i]);
        CHECK(sti[at] > 0.0);
    }
    CHECK_NEAR(area, 94.0, 1e-9);
    CHECK_NEAR(absorbed, 0.98, 0.02);  // the air takes the rest
    CHECK_OK(es_result_write(result, ES_SENSITIVITY_JSON, "sensitivity.json"));
    CHECK_FAILS(ES_ERROR_NULL, "sensitivity", es_result_sensitivity(result, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "metric",
                es_result_derivative(result, ES_METRIC_LF, 0, &t30, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "values", es_result_derivative(result, 0, 0, NULL, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "shape", es_result_derivative(result, 0, 0, &t30, NULL, NULL));
    es_simulation_options options = early_options(1);
    options.sensitivity = 1;
    options.paths = 0;
    es_result none = 0;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "sensitivity", es_simulate(scene, &options, &none));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}

/// A value that is missing has a reason.
static void test_reasons(void) {
    es_scene scene = make_room(0.9);
    es_simulation_options options = early_options(1);
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &options, &result));
    const double* values = NULL;
    size_t shape[3];
    const char* text = NULL;
    CHECK_OK(
        es_result_metric(result, ES_METRIC_T30, ES_EXPECTED, ES_PER_BAND, &values, NULL, shape));
    for (uint32_t band = 0; band < 10; ++band) {
        CHECK(isnan(values[band]));  // seven arrivals do not decay by 35 dB
        CHECK_OK(es_result_metric_note(result, ES_METRIC_T30, ES_EXPECTED, 0, 0, band, &text));
        CHECK(text[0] != '\0');
    }
    CHECK_OK(es_result_metric_note(result, ES_METRIC_T30, ES_EXPECTED, 0, 0, ES_NONE, &text));
    CHECK(text[0] != '\0');
    CHECK_FAILS(ES_ERROR_INDEX, "band", es_result_metric_note(result, 0, 0, 0, 0, 10, &text));
    CHECK_FAILS(ES_ERROR_INDEX, "source", es_result_metric_note(result, 0, 0, 1, 0, 0, &text));
    CHECK_FAILS(ES_ERROR_INDEX, "listener", es_result_metric_note(result, 0, 0, 0, 1, 0, &text));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "metric", es_result_metric_note(result, 14, 0, 0, 0, 0, &text));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "set", es_result_metric_note(result, 0, 2, 0, 0, 0, &text));
    CHECK_FAILS(ES_ERROR_NULL, "text", es_result_metric_note(result, 0, 0, 0, 0, 0, NULL));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}

static void test_formats(void) {
    es_scene scene = make_room(0.4);
    const double second[3] = {2.0, 1.0, 3.0};
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, second, NULL, 1, NULL));
    const float* samples = NULL;
    const uint64_t* lengths = NULL;
    size_t shape[4];
    es_result result = simulate(scene, ES_FORMAT_AMBISONIC, 1);
    CHECK_OK(es_result_responses(result, &samples, shape));
    CHECK(shape[1] == 2 && shape[2] == 4);
    CHECK_OK(es_result_lengths(result, &lengths, shape));
    CHECK(shape[0] == 1 && shape[1] == 2);
    es_result_info info = {.struct_size = sizeof info};
    CHECK_OK(es_result_get_info(result, &info));
    CHECK(info.samples == (lengths[0] > lengths[1] ? lengths[0] : lengths[1]));
    // The shorter response ends in zeros.
    for (size_t pair = 0; pair < 2; ++pair) {
        for (size_t n = lengths[pair]; n < info.samples; ++n) {
            CHECK(samples[pair * 4 * info.samples + n] == 0.0f);
        }
    }
    CHECK(metric(result, ES_METRIC_LF, ES_RESPONSE, ES_PER_BAND, 5) >= 0.0);
    CHECK_FAILS(
        ES_ERROR_FAILED,
        "iacc",
        es_result_metric(
            result, ES_METRIC_IACC, ES_RESPONSE, ES_PER_BAND, &(const double*){NULL}, NULL, shape));
    CHECK_OK(es_release(result));
    result = simulate(scene, ES_FORMAT_BINAURAL, 1);
    CHECK_OK(es_result_responses(result, &samples, shape));
    CHECK(shape[2] == 2);
    for (int32_t which = ES_METRIC_IACC_EARLY; which <= ES_METRIC_IACC; ++which) {
        const double value = metric(result, which, ES_RESPONSE, ES_PER_BAND, 4);
        CHECK(value > 0.0 && value <= 1.0 + 1e-12);
    }
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}

void test_results(void) {
    test_diffuse_room();
    test_sensitivity();
    test_reasons();
    test_formats();
    const char *key = NULL, *unit = NULL;
    const char* keys[] = {"edt",
                          "t20",
                          "t30",
                          "c50",
                          "c80",
                          "d50",
                          "ts",
                          "g",
                          "sti",
                          "schroeder_hz",
                          "lf",
                          "iacc_early",
                          "iacc_late",
                          "iacc"};
    for (int32_t which = ES_METRIC_EDT; which <= ES_METRIC_IACC; ++which) {
        double difference = 0.0;
        int32_t relative = 7;
        CHECK_OK(es_metric_get(which, &key, &unit, &difference, &relative));
        CHECK_TEXT(key, keys[which]);
        CHECK(unit != NULL && (relative == 0 || relative == 1));
        CHECK(isnan(difference) || difference > 0.0);
    }
    CHECK_OK(es_metric_get(0, NULL, NULL, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "metric", es_metric_get(14, &key, NULL, NULL, NULL));
}

/// What cannot be written to a SOFA file together.
static void test_sofa_errors(es_scene scene, es_result bare) {
    es_simulation_options options = early_options(1);
    es_result results[3] = {0, 0, 0};
    options.metrics = 0;
    options.responses = 0;
    options.sofa = 1;
    options.length = 0.05;
    CHECK_OK(es_simulate(scene, &options, &results[0]));
    options.sample_rate = 8000.0;
    CHECK_OK(es_simulate(scene, &options, &results[1]));
    const es_result slow = results[1];
    options.sample_rate = 48000.0;
    options.format = ES_FORMAT_AMBISONIC;
    CHECK_OK(es_simulate(scene, &options, &results[2]));
    CHECK_OK(es_results_write_sofa(results, 1, "one.sofa"));
    CHECK_OK(es_results_write_sofa(results + 2, 1, "four.sofa"));
    CHECK_FAILS(ES_ERROR_FAILED, "sample rate", es_results_write_sofa(results, 2, "x.sofa"));
    results[1] = results[2];
    CHECK_FAILS(
        ES_ERROR_FAILED, "results[1]: differs", es_results_write_sofa(results, 2, "x.sofa"));
    CHECK_FAILS(ES_ERROR_FAILED, "64 bits", es_results_write_sofa(&bare, 1, "x.sofa"));
    CHECK_FAILS(ES_ERROR_NULL, "results", es_results_write_sofa(NULL, 1, "x.sofa"));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_results_write_sofa(results, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "count", es_results_write_sofa(results, 0, "x.sofa"));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "count", es_results_write_sofa(results, SIZE_MAX, "x.sofa"));
    CHECK_FAILS(ES_ERROR_HANDLE, "results", es_results_write_sofa(&scene, 1, "x.sofa"));
    CHECK_FAILS(ES_ERROR_FAILED, "no/such", es_results_write_sofa(results, 1, "no/such/x.sofa"));
    FILE* file = fopen("x.sofa", "r");
    CHECK(file == NULL);  // what fails writes nothing
    CHECK_OK(es_release(slow));
    CHECK_OK(es_release(results[0]));
    CHECK_OK(es_release(results[2]));
}

void test_result_errors(void) {
    es_scene scene = make_room(0.4);
    es_result full = simulate(scene, ES_FORMAT_MONO, 1), bare = simulate(scene, ES_FORMAT_MONO, 0);
    const double* values = NULL;
    const float* samples = NULL;
    const uint64_t* lengths = NULL;
    const char* text = NULL;
    es_sound sound = 0;
    size_t shape[4], count = 0;

    test_sofa_errors(scene, bare);
    // What was not asked for.
    CHECK_FAILS(ES_ERROR_FAILED, "responses", es_result_responses(bare, &samples, shape));
    CHECK_FAILS(ES_ERROR_FAILED, "responses", es_result_lengths(bare, &lengths, shape));
    CHECK_FAILS(ES_ERROR_FAILED, "responses", es_result_sound(bare, 0, 0, &sound));
    CHECK_FAILS(ES_ERROR_FAILED, "metrics", es_result_metric(bare, 0, 0, 0, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_FAILED, "metrics", es_result_metric_note(bare, 0, 0, 0, 0, 0, &text));
    CHECK_FAILS(ES_ERROR_FAILED, "metrics", es_result_write(bare, ES_METRICS_JSON, "metrics.json"));
    CHECK_FAILS(
        ES_ERROR_FAILED, "sensitivity", es_result_write(bare, ES_SENSITIVITY_JSON, "s.json"));
    es_sensitivity sensitivity = {.struct_size = sizeof sensitivity};
    CHECK_FAILS(ES_ERROR_FAILED, "sensitivity", es_result_sensitivity(bare, &sensitivity));
    CHECK_FAILS(ES_ERROR_FAILED,
                "sensitivity",
                es_result_derivative(bare, ES_METRIC_T30, 0, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_FAILED, "histograms", es_result_write(bare, ES_HISTOGRAMS_JSON, "h.json"));
    es_histogram histogram = {.struct_size = sizeof histogram};
    CHECK_OK(es_result_histogram(bare, 0, 0, &histogram));
    CHECK(histogram.energy == NULL && histogram.bin_count == 0 && histogram.rays == 20000);
    es_room room = {.struct_size = sizeof room};
    CHECK_OK(es_result_room(bare, &room));
    CHECK(room.is_enclosed == 0 && room.eyring == NULL);

    // Documents.
    CHECK_OK(es_result_write(full, ES_PATHS_JSON, "paths.json"));
    CHECK_OK(es_result_write(full, ES_METRICS_JSON, "metrics.json"));
    CHECK_OK(es_result_write(full, ES_HISTOGRAMS_JSON, "histograms.json"));
    FILE* file = fopen("paths.json", "r");
    CHECK(file != NULL);
    char head[64] = "";
    CHECK(fgets(head, sizeof head, file) != NULL &&
          strstr(head, "{\"version\":1,\"scene\":\"shoebox\"") == head);
    fclose(file);
    CHECK_FAILS(ES_ERROR_ARGUMENT, "document", es_result_write(full, 4, "x.json"));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_result_write(full, ES_PATHS_JSON, NULL));
    CHECK_FAILS(ES_ERROR_FAILED,
                "no/such/folder",
                es_result_write(full, ES_PATHS_JSON, "no/such/folder/x.json"));

    // Arguments.
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "metric", es_result_metric(full, -1, 0, 0, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "set", es_result_metric(full, 0, 2, 0, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "form", es_result_metric(full, 0, 0, 2, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_FAILED,
                "sti",
                es_result_metric(full, ES_METRIC_STI, 0, ES_PER_BAND, &values, NULL, shape));
    CHECK_FAILS(
        ES_ERROR_FAILED, "lf", es_result_metric(full, ES_METRIC_LF, 1, 0, &values, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "values", es_result_metric(full, 0, 0, 0, NULL, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "shape", es_result_metric(full, 0, 0, 0, &values, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "samples", es_result_responses(full, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "shape", es_result_responses(full, &samples, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "lengths", es_result_lengths(full, NULL, shape));
    CHECK_FAILS(ES_ERROR_NULL, "shape", es_result_lengths(full, &lengths, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "source", es_result_sound(full, 1, 0, &sound));
    CHECK_FAILS(ES_ERROR_INDEX, "listener", es_result_sound(full, 0, SIZE_MAX, &sound));
    CHECK_FAILS(ES_ERROR_NULL, "sound", es_result_sound(full, 0, 0, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "listener", es_result_histogram(full, 0, 1, &histogram));
    CHECK_FAILS(ES_ERROR_NULL, "histogram", es_result_histogram(full, 0, 0, NULL));
    histogram.struct_size = 0;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_result_histogram(full, 0, 0, &histogram));
    CHECK_FAILS(ES_ERROR_NULL, "room", es_result_room(full, NULL));
    room.struct_size = 1000;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_result_room(full, &room));
    CHECK_FAILS(ES_ERROR_NULL, "arrays", es_result_paths(full, NULL));
    es_path_arrays arrays = {.struct_size = 4};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_result_paths(full, &arrays));
    es_result_info info = {.struct_size = 0};
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_result_get_info(full, &info));
    CHECK_FAILS(ES_ERROR_NULL, "info", es_result_get_info(full, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "nominal_hz", es_result_bands(full, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_result_bands(full, &values, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "messages", es_result_notes(full, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "result", es_result_bands(scene, &values, &count));
    CHECK_OK(es_release(full));
    CHECK_OK(es_release(bare));
    CHECK_OK(es_release(scene));
}
