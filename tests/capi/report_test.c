// SPDX-License-Identifier: MIT
// Report pages of results.
#include "check.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Whether the file exists and holds the text.
static int file_holds(const char* name, const char* text) {
    FILE* file = fopen(name, "rb");
    if (file == NULL) {
        return 0;
    }
    static char content[1 << 22];
    const size_t size = fread(content, 1, sizeof content - 1, file);
    content[size] = '\0';
    fclose(file);
    return strstr(content, text) != NULL;
}

void test_reports(void) {
    es_scene scene = make_room(0.3);
    es_simulation_options simulation = early_options(2);
    simulation.rays = 4000;
    simulation.rays_error = 0.0;
    simulation.histograms = 1;
    simulation.sensitivity = 1;
    es_result result = 0;
    CHECK_OK(es_simulate(scene, &simulation, &result));

    const char* const limits[] = {"sti=0.99", "t30=9"};
    es_report_options options;
    CHECK_OK(es_report_options_init(&options, sizeof options));
    options.scene = scene;
    options.title = "a <box>";
    options.command = "made in C";
    options.limits = limits;
    options.limit_count = 2;
    CHECK_OK(es_result_write_report(result, &options, "report.json"));
    CHECK(file_holds("report.json", "\"title\":\"a <box>\""));
    CHECK(file_holds("report.json", "\"command\":\"made in C\""));
    CHECK(file_holds("report.json", "\"positions_f32\""));
    CHECK(file_holds("report.json", "\"level_db\""));
    CHECK(file_holds("report.json", "\"sensitivity\""));
    CHECK(file_holds("report.json", "Is STI at least 0.99 everywhere?"));
    CHECK(file_holds("report.json", "\"missed\"") && file_holds("report.json", "\"met\""));
    CHECK_OK(es_result_write_report(result, NULL, "bare.json"));
    CHECK(file_holds("bare.json", "\"title\":\"shoebox\""));
    CHECK(!file_holds("bare.json", "\"positions_f32\""));

    CHECK_OK(es_result_write(result, ES_METRICS_JSON, "before.json"));
    options.reference_file = "before.json";
    CHECK_OK(es_result_write_report(result, &options, "report.json"));
    CHECK(file_holds("report.json", "\"name\":\"before.json\""));
    if (es_has_report_page()) {
        CHECK_OK(es_result_write_report(result, &options, "page.html"));
        CHECK(file_holds("page.html", "a \\u003cbox\\u003e"));
    } else {
        CHECK_FAILS(ES_ERROR_FAILED,
                    "report/bundle",
                    es_result_write_report(result, &options, "page.html"));
    }

    CHECK_FAILS(ES_ERROR_NULL, "file", es_result_write_report(result, &options, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "result", es_result_write_report(scene, &options, "x.json"));
    options.reference_file = "report.json";
    CHECK_FAILS(ES_ERROR_FAILED, "report.json", es_result_write_report(result, &options, "x.json"));
    options.reference_file = NULL;
    options.scene = result;
    CHECK_FAILS(ES_ERROR_HANDLE, "scene", es_result_write_report(result, &options, "x.json"));
    options.scene = 0;
    options.limits = NULL;
    CHECK_FAILS(ES_ERROR_NULL, "limits", es_result_write_report(result, &options, "x.json"));
    const char* const wrong[] = {"loudness=3"};
    options.limits = wrong;
    options.limit_count = 1;
    CHECK_FAILS(ES_ERROR_FAILED, "loudness=3", es_result_write_report(result, &options, "x.json"));
    options.struct_size = 3;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "struct_size", es_result_write_report(result, &options, "x.json"));
    CHECK_OK(es_release(result));
    CHECK_OK(es_release(scene));
}
