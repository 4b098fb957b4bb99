// SPDX-License-Identifier: MIT
// Absorption fitted to the metrics of a simulation.
#include "check.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double kBand = 1000.0;

static es_simulation_options fit_options(void) {
    es_simulation_options options = early_options(2);
    options.rays = 1024;
    return options;
}

/// T30 and G at 1 kHz of the scene's pairs.
static size_t measure(es_scene scene, es_measured_metric* measured) {
    es_simulation_options simulation = fit_options();
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &simulation, &result));
    const int32_t metrics[2] = {ES_METRIC_T30, ES_METRIC_G};
    size_t count = 0;
    for (int k = 0; k < 2; ++k) {
        const double* values = NULL;
        size_t shape[3];
        CHECK_OK(
            es_result_metric(result, metrics[k], ES_EXPECTED, ES_PER_BAND, &values, NULL, shape));
        for (uint32_t listener = 0; listener < shape[1]; ++listener) {
            const double value = values[listener * shape[2] + 5];
            if (!isnan(value)) {
                const es_measured_metric row = {
                    0, listener, metrics[k], 0, kBand, value, 0.01 * fabs(value)};
                measured[count++] = row;
            }
        }
    }
    CHECK_OK(es_release(result));
    return count;
}

static void test_fit(void) {
    es_scene scene = make_room(0.4);
    es_scene wrong = make_room(0.25);
    const double more[] = {4.2, 0.9, 3.1, 2.0, 1.2, 3.0};
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, more, NULL, 2, NULL));
    CHECK_OK(es_scene_add(wrong, ES_LISTENERS, more, NULL, 2, NULL));
    es_measured_metric measured[16];
    const size_t count = measure(scene, measured);
    CHECK(count > 0);
    es_simulation_options simulation = fit_options();
    es_calibration calibration = 0;
    const es_status status = es_calibrate(wrong, &simulation, NULL, measured, count, &calibration);
    if (status == ES_ERROR_FAILED && strstr(es_error_message(), "without Ceres") != NULL) {
        CHECK_OK(es_release(scene));
        CHECK_OK(es_release(wrong));
        return;
    }
    CHECK(status == ES_OK);
    CHECK(es_kind_of(calibration) == ES_KIND_CALIBRATION);
    es_calibration_info info = {.struct_size = sizeof info};
    CHECK_OK(es_calibration_get_info(calibration, &info));
    CHECK(info.metrics == count && info.bands == 10 && info.simulations >= 2);

    // The mean absorption is that of the truth, whichever surfaces it is on.
    const double *fitted = NULL, *lower = NULL, *upper = NULL;
    size_t shape[2];
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_ABSORPTION, &fitted, shape));
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_LOWER, &lower, shape));
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_UPPER, &upper, shape));
    CHECK(shape[0] == info.materials && shape[1] == info.bands);
    double mean = 0.0;
    for (size_t i = 0; i < shape[0]; ++i) {
        mean += fitted[i * shape[1] + 5] / (double)shape[0];
        CHECK(lower[i * shape[1] + 5] <= fitted[i * shape[1] + 5]);
        CHECK(upper[i * shape[1] + 5] >= fitted[i * shape[1] + 5]);
    }
    CHECK_NEAR(mean, 0.4, 0.06);
    const double *before = NULL, *after = NULL, *values = NULL;
    size_t metric_count = 0;
    CHECK_OK(es_calibration_metrics(calibration, &values, &before, &after, NULL, &metric_count));
    CHECK(metric_count == count);
    for (size_t i = 0; i < count; ++i) {
        CHECK_NEAR(values[i], measured[i].value, 0.0);
        CHECK(fabs(after[i] - values[i]) < fabs(before[i] - values[i]));
    }
    const char* json = NULL;
    CHECK_OK(es_calibration_json(calibration, &json));
    CHECK(strstr(json, "\"reduced_chi_squared\"") != NULL);
    es_messages warnings = 0;
    CHECK_OK(es_calibration_warnings(calibration, &warnings));
    CHECK_OK(es_release(warnings));
    CHECK_OK(es_calibration_write(calibration, "fitted.materials.json"));
    CHECK_OK(es_calibration_apply(calibration, wrong));
    CHECK_FAILS(ES_ERROR_HANDLE, "calibration", es_calibration_apply(wrong, wrong));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "table", es_calibration_values(calibration, 9, &values, shape));
    CHECK_OK(es_release(calibration));

    es_calibration_options options;
    CHECK_OK(es_calibration_options_init(&options, sizeof options));
    options.fit_scattering = 1;
    options.max_simulations = 1;
    CHECK_OK(es_calibrate(wrong, &simulation, &options, measured, count, &calibration));
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_SCATTERING, &fitted, shape));
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_SCATTERING_LOWER, &lower, shape));
    CHECK_OK(es_calibration_values(calibration, ES_CALIBRATION_SCATTERING_UPPER, &upper, shape));
    for (size_t i = 0; i < shape[0] * shape[1]; ++i) {
        CHECK(lower[i] <= fitted[i] && fitted[i] <= upper[i]);
    }
    CHECK_FAILS(ES_ERROR_ARGUMENT, "table", es_calibration_values(calibration, 18, &values, shape));
    options.fit_scattering = 2;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "options->fit_scattering",
                es_calibrate(wrong, &simulation, &options, measured, count, &calibration));
    options.fit_scattering = 0;
    options.reserved = 1;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "options->reserved",
                es_calibrate(wrong, &simulation, &options, measured, count, &calibration));
    CHECK_OK(es_release(calibration));
    CHECK_OK(es_release(scene));
    CHECK_OK(es_release(wrong));
}

static void test_arguments(void) {
    es_scene scene = make_room(0.3);
    es_calibration calibration = 0;
    const es_measured_metric good = {0, 0, ES_METRIC_T30, 0, kBand, 0.5, 0.0};
    es_measured_metric bad = good;
#define REFUSES(expected, argument, measured) \
    CHECK_FAILS(expected, argument, es_calibrate(scene, NULL, NULL, measured, 1, &calibration))
    bad.source = 7;
    REFUSES(ES_ERROR_INDEX, "measured->source", &bad);
    bad = good;
    bad.metric = ES_METRIC_STI;
    REFUSES(ES_ERROR_ARGUMENT, "measured->metric", &bad);
    bad = good;
    bad.band_hz = 440.0;
    REFUSES(ES_ERROR_ARGUMENT, "measured->band_hz", &bad);
    bad = good;
    bad.value = NAN;
    REFUSES(ES_ERROR_ARGUMENT, "measured->value", &bad);
    bad = good;
    bad.error = -1.0;
    REFUSES(ES_ERROR_ARGUMENT, "measured->error", &bad);
    REFUSES(ES_ERROR_NULL, "measured", NULL);
#undef REFUSES
    es_calibration_options options;
    CHECK_OK(es_calibration_options_init(&options, sizeof options));
    options.spread = 0.0;
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "options->spread",
                es_calibrate(scene, NULL, &options, &good, 1, &calibration));
    CHECK_OK(es_calibration_options_init(&options, sizeof options));
    options.measured = "absent.csv";
    CHECK_FAILS(
        ES_ERROR_FAILED, "absent.csv", es_calibrate(scene, NULL, &options, NULL, 0, &calibration));
    CHECK(calibration == 0);
    CHECK_OK(es_release(scene));
}

void test_calibrations(void) {
    test_fit();
    test_arguments();
}
