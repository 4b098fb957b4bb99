// SPDX-License-Identifier: MIT
// Acoustic data of materials, the library, bands.
#include "check.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static double at_1khz(es_scene scene, const char* name, int32_t coefficient) {
    uint32_t index = 0;
    double values[10];
    CHECK_OK(es_scene_find(scene, ES_MATERIALS, name, &index));
    CHECK_OK(es_scene_coefficients(scene, index, coefficient, ES_BANDS_OCTAVE, values, 10));
    return values[5];
}

static void test_bands(void) {
    const double* hz = NULL;
    size_t count = 0;
    CHECK_OK(es_bands_nominal(ES_BANDS_OCTAVE, &hz, &count));
    CHECK(count == 10);
    CHECK_NEAR(hz[0], 31.5, 0.0);
    CHECK_NEAR(hz[9], 16000.0, 0.0);
    CHECK_OK(es_bands_nominal(ES_BANDS_THIRD, &hz, &count));
    CHECK(count == 31);
    CHECK_NEAR(hz[30], 20000.0, 0.0);
    CHECK_FAILS(ES_ERROR_ARGUMENT, "bands", es_bands_nominal(2, &hz, &count));
    CHECK_FAILS(ES_ERROR_NULL, "nominal_hz", es_bands_nominal(0, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_bands_nominal(0, &hz, NULL));
}

static void test_library(void) {
    const char *name = NULL, *description = NULL, *source = NULL;
    char last[64] = "";
    CHECK(es_library_count() >= 90);
    for (size_t i = 0; i < es_library_count(); ++i) {
        CHECK_OK(es_library_get(i, &name, &description, &source));
        CHECK(strcmp(last, name) < 0);  // in order
        CHECK(description[0] != '\0' && source[0] != '\0');
        snprintf(last, sizeof last, "%s", name);
        double values[31];
        CHECK_OK(es_library_coefficients(i, ES_ABSORPTION, ES_BANDS_THIRD, values, 31));
        for (int band = 0; band < 31; ++band) {
            CHECK(values[band] >= 0.0 && values[band] <= 1.0);
        }
    }
    CHECK_OK(es_library_get(0, NULL, NULL, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_library_get(es_library_count(), &name, NULL, NULL));
    double values[10];
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_library_coefficients(SIZE_MAX, 0, 0, values, 10));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "coefficient", es_library_coefficients(0, 3, 0, values, 10));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "bands", es_library_coefficients(0, 0, -1, values, 10));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "band_count", es_library_coefficients(0, 0, 0, values, 9));
    CHECK_FAILS(ES_ERROR_NULL, "values", es_library_coefficients(0, 0, 0, NULL, 10));
}

static void test_assignments(void) {
    es_scene scene = make_room(0.3);
    es_material material;
    size_t matches = 99;
    // Linear over the logarithm of the frequency: half way from 500 Hz to 2 kHz is 1 kHz.
    const double frequencies[] = {2000.0, 500.0}, absorption[] = {0.4, 0.2};
    const double transmission[] = {0.1, 0.1};
    CHECK_OK(es_material_init(&material, sizeof material));
    material.frequency_count = 2;
    material.frequencies = frequencies;
    material.absorption = absorption;
    material.transmission = transmission;
    CHECK_OK(es_scene_assign(scene, "[nws]*th", &material, &matches));
    CHECK(matches == 2);  // north, south
    CHECK_NEAR(at_1khz(scene, "north", ES_ABSORPTION), 0.3, 1e-12);
    CHECK_NEAR(at_1khz(scene, "south", ES_TRANSMISSION), 0.1, 1e-12);
    CHECK_NEAR(at_1khz(scene, "south", ES_SCATTERING), 0.1, 0.0);  // the default
    CHECK_NEAR(at_1khz(scene, "east", ES_SCATTERING), 0.0, 0.0);   // not touched
    CHECK_OK(es_scene_assign(scene, "nothing", &material, &matches));
    CHECK(matches == 0);
    CHECK_OK(es_scene_assign(scene, "nothing", &material, NULL));

    CHECK_OK(es_scene_assign_library(scene, "floor", "brick-painted", &matches));
    CHECK(matches == 1);
    CHECK(at_1khz(scene, "floor", ES_ABSORPTION) < 0.05);
    CHECK_FAILS(ES_ERROR_FAILED,
                "brick-painted",
                es_scene_assign_library(scene, "floor", "brick-paintd", NULL));
    CHECK_FAILS(
        ES_ERROR_NULL, "pattern", es_scene_assign_library(scene, NULL, "brick-painted", NULL));
    CHECK_FAILS(ES_ERROR_NULL, "library_name", es_scene_assign_library(scene, "floor", NULL, NULL));

    FILE* file = fopen("materials.json", "w");
    fputs("{\"*st\": {\"absorption\": 0.7}}", file);
    fclose(file);
    CHECK_OK(es_scene_assign_file(scene, "materials.json"));
    CHECK_NEAR(at_1khz(scene, "west", ES_ABSORPTION), 0.7, 0.0);
    CHECK_FAILS(ES_ERROR_FAILED, "none.json", es_scene_assign_file(scene, "none.json"));
    CHECK_FAILS(ES_ERROR_NULL, "file", es_scene_assign_file(scene, NULL));

    const double one = 0.9;
    CHECK_OK(es_material_init(&material, sizeof material));
    material.absorption = &one;
    CHECK_OK(es_scene_set_material(scene, 1, &material));
    CHECK_NEAR(at_1khz(scene, "ceiling", ES_ABSORPTION), 0.9, 0.0);
    CHECK_FAILS(ES_ERROR_INDEX, "index", es_scene_set_material(scene, 6, &material));
    CHECK_FAILS(ES_ERROR_NULL, "material", es_scene_set_material(scene, 1, NULL));

    // What is no material.
    const double too_much = 1.1, nan = NAN;
    material.absorption = &too_much;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "material->absorption", es_scene_assign(scene, "*", &material, NULL));
    material.absorption = NULL;
    material.scattering = &nan;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "material->scattering", es_scene_assign(scene, "*", &material, NULL));
    material.scattering = NULL;
    material.transmission = &one;  // more than is absorbed
    CHECK_FAILS(ES_ERROR_FAILED, "", es_scene_assign(scene, "*", &material, NULL));
    material.transmission = NULL;
    material.one_sided = 7;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "one_sided", es_scene_assign(scene, "*", &material, NULL));
    material.one_sided = 1;
    material.frequency_count = 2;
    CHECK_FAILS(ES_ERROR_NULL, "frequencies", es_scene_assign(scene, "*", &material, NULL));
    const double same[] = {500.0, 500.0};
    material.frequencies = same;
    material.absorption = absorption;
    CHECK_FAILS(ES_ERROR_FAILED, "", es_scene_assign(scene, "*", &material, NULL));
    material.frequency_count = SIZE_MAX;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "frequency_count", es_scene_assign(scene, "*", &material, NULL));
    material.frequency_count = 0;
    CHECK_FAILS(ES_ERROR_NULL, "pattern", es_scene_assign(scene, NULL, &material, NULL));
    material.struct_size = 1;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_scene_assign(scene, "*", &material, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_material_init(&material, 1));

    double values[10];
    CHECK_FAILS(ES_ERROR_INDEX, "material", es_scene_coefficients(scene, 6, 0, 0, values, 10));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "coefficient", es_scene_coefficients(scene, 0, -1, 0, values, 10));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "band_count", es_scene_coefficients(scene, 0, 0, 1, values, 10));
    CHECK_OK(es_release(scene));
}

void test_materials(void) {
    test_bands();
    test_library();
    test_assignments();
}
