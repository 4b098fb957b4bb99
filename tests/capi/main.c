// SPDX-License-Identifier: MIT
// Runs a group of tests of the C interface: PROGRAM GROUP PROJECT_FOLDER, in a folder of its own.
#include "check.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char* project_folder;

static void fail(const char* file, int line) {
    fprintf(stderr, "%s:%d: the last failure told: %s\n", file, line, es_error_message());
    exit(1);
}

void check(int holds, const char* what, const char* file, int line) {
    if (!holds) {
        fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
        fail(file, line);
    }
}

void check_near(
    double value, double expected, double tolerance, const char* what, const char* file, int line) {
    if (!(fabs(value - expected) <= tolerance)) {
        fprintf(stderr,
                "%s:%d: %s is %.17g, not %.17g within %g\n",
                file,
                line,
                what,
                value,
                expected,
                tolerance);
        fail(file, line);
    }
}

void check_text(
    const char* value, const char* expected, const char* what, const char* file, int line) {
    if (value == NULL || strcmp(value, expected) != 0) {
        fprintf(stderr, "%s:%d: %s is \"%s\", not \"%s\"\n", file, line, what, value, expected);
        fail(file, line);
    }
}

void check_ok(es_status status, const char* what, const char* file, int line) {
    if (status != ES_OK) {
        fprintf(stderr, "%s:%d: fails with %s: %s\n", file, line, es_status_name(status), what);
        fail(file, line);
    }
}

void check_fails(es_status expected,
                 const char* text,
                 es_status status,
                 const char* what,
                 const char* file,
                 int line) {
    if (status != expected || es_error_status() != expected) {
        fprintf(stderr,
                "%s:%d: gives %s, not %s: %s\n",
                file,
                line,
                es_status_name(status),
                es_status_name(expected),
                what);
        fail(file, line);
    }
    if (strstr(es_error_message(), text) == NULL || es_error_problem()[0] == '\0') {
        fprintf(stderr, "%s:%d: the message lacks \"%s\": %s\n", file, line, text, what);
        fail(file, line);
    }
}

const char* project_file(const char* name) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", project_folder, name);
    return path;
}

es_scene make_room(double absorption) {
    const double size[3] = {5.0, 3.0, 4.0};
    const double source[3] = {1.0, 1.2, 1.5}, listener[3] = {3.5, 1.7, 2.5};
    const double no_scattering = 0.0;
    es_material material;
    CHECK_OK(es_material_init(&material, sizeof material));
    material.absorption = &absorption;
    material.scattering = &no_scattering;
    es_scene scene = 0;
    CHECK_OK(es_scene_create_shoebox(size, &scene));
    CHECK_OK(es_scene_assign(scene, "*", &material, NULL));
    CHECK_OK(es_scene_add(scene, ES_SOURCES, source, NULL, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, listener, NULL, 1, NULL));
    return scene;
}

es_simulation_options early_options(int32_t order) {
    es_simulation_options options;
    CHECK_OK(es_simulation_options_init(&options, sizeof options));
    options.order = order;
    options.rays = 0;
    return options;
}

int main(int argc, char** argv) {
    static const struct {
        const char* name;
        void (*run)(void);
    } groups[] = {{"errors", test_errors},
                  {"handles", test_handles},
                  {"scenes", test_scenes},
                  {"scene_arrays", test_scene_arrays},
                  {"materials", test_materials},
                  {"emitters", test_emitters},
                  {"simulation", test_simulation},
                  {"simulation_options", test_simulation_options},
                  {"results", test_results},
                  {"result_errors", test_result_errors},
                  {"reports", test_reports},
                  {"sounds", test_sounds},
                  {"path_sounds", test_path_sounds},
                  {"bvh", test_bvh},
                  {"sight", test_sight},
                  {"worlds", test_worlds},
                  {"world_errors", test_world_errors},
                  {"visible_sets", test_visible_sets},
                  {"maps", test_maps},
                  {"calibrations", test_calibrations},
                  {"simplifications", test_simplifications},
                  {"locations", test_locations},
                  {"checks", test_checks},
                  {"engines", test_engines},
                  {"without_module", test_without_module},
                  {"threads", test_threads}};
    if (argc != 3) {
        fprintf(stderr, "usage: %s GROUP PROJECT_FOLDER\n", argv[0]);
        return 2;
    }
    project_folder = argv[2];
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; ++i) {
        if (strcmp(argv[1], groups[i].name) == 0) {
            const size_t before = es_object_count();
            groups[i].run();
            CHECK(es_object_count() == before);  // a group releases what it makes
            return 0;
        }
    }
    fprintf(stderr, "%s: no such group\n", argv[1]);
    return 2;
}
