// SPDX-License-Identifier: MIT
// Scenes that programs make.
#include "check.h"
#include <math.h>
#include <string.h>

static void test_arrays(void) {
    const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 0, 1, 5, 0, 0, 6, 0, 0, 5, 0, 1};
    const uint32_t triangles[] = {0, 2, 1, 3, 5, 4};
    const uint32_t materials[] = {1, 0}, meshes[] = {0, 1};
    const char* material_names[] = {"mine", "brick-painted"};
    const char* mesh_names[] = {"left", "right"};
    es_scene_arrays arrays;
    CHECK_OK(es_scene_arrays_init(&arrays, sizeof arrays));
    arrays.name = "two";
    arrays.vertices = vertices;
    arrays.vertex_count = 6;
    arrays.triangles = triangles;
    arrays.triangle_count = 2;
    es_scene scene = 0;
    const char* name = NULL;

    // One material and one mesh, where none are told.
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK_OK(es_scene_item_name(scene, ES_MATERIALS, 0, &name));
    CHECK_TEXT(name, "material 0");
    CHECK_OK(es_scene_item_name(scene, ES_MESHES, 0, &name));
    CHECK_TEXT(name, "mesh 0");
    CHECK_OK(es_release(scene));

    arrays.material_of_triangle = materials;
    arrays.material_names = material_names;
    arrays.material_count = 2;
    arrays.mesh_of_triangle = meshes;
    arrays.mesh_names = mesh_names;
    arrays.mesh_count = 2;
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK_OK(es_scene_name(scene, &name));
    CHECK_TEXT(name, "two");
    CHECK_OK(es_scene_item_name(scene, ES_MESHES, 1, &name));
    CHECK_TEXT(name, "right");
    // The name of a library material gives its data: 0.018 at 1 kHz differs from the default.
    double of_mine[10], of_brick[10];
    CHECK_OK(es_scene_coefficients(scene, 0, ES_ABSORPTION, ES_BANDS_OCTAVE, of_mine, 10));
    CHECK_OK(es_scene_coefficients(scene, 1, ES_ABSORPTION, ES_BANDS_OCTAVE, of_brick, 10));
    CHECK_NEAR(of_mine[5], 0.1, 0.0);
    CHECK(of_brick[5] < 0.05);
    CHECK_OK(es_release(scene));

    // Errors, one after the other.
    const uint32_t wrong_triangles[] = {0, 2, 6, 3, 5, 4}, wrong_numbers[] = {0, 2};
    const double wrong_vertices[] = {0, 0, 0, 1, NAN, 0, 0, 0, 1, 5, 0, 0, 6, 0, 0, 5, 0, 1};
    es_scene_arrays wrong = arrays;
    wrong.triangles = wrong_triangles;
    CHECK_FAILS(
        ES_ERROR_INDEX, "arrays->triangles[0]: names vertex 6", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.vertices = wrong_vertices;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "arrays->vertices[1]", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.vertices = NULL;
    CHECK_FAILS(ES_ERROR_NULL, "arrays->vertices", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.triangles = NULL;
    CHECK_FAILS(ES_ERROR_NULL, "arrays->triangles", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.vertex_count = SIZE_MAX;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "arrays->vertices", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.triangle_count = SIZE_MAX / 2;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "arrays->triangles", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.material_of_triangle = wrong_numbers;
    CHECK_FAILS(ES_ERROR_INDEX, "material_of_triangle", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.mesh_of_triangle = wrong_numbers;
    CHECK_FAILS(ES_ERROR_INDEX, "mesh_of_triangle", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.material_count = SIZE_MAX;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "material_count", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.mesh_count = SIZE_MAX;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "mesh_count", es_scene_create(&wrong, &scene));
    const char* no_names[] = {"a", NULL};
    wrong = arrays;
    wrong.material_names = no_names;
    CHECK_FAILS(ES_ERROR_NULL, "material_names", es_scene_create(&wrong, &scene));
    // A vertex of two meshes.
    const uint32_t shared[] = {0, 2, 1, 0, 5, 4};
    wrong = arrays;
    wrong.triangles = shared;
    CHECK_FAILS(ES_ERROR_FAILED, "mesh", es_scene_create(&wrong, &scene));
    wrong = arrays;
    wrong.struct_size = 8;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "arrays->struct_size", es_scene_create(&wrong, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "arrays", es_scene_create(NULL, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "scene", es_scene_create(&arrays, NULL));

    // Without geometry it is a scene that cannot be simulated.
    es_messages messages = 0;
    double lower[3], upper[3];
    size_t count = 0;
    CHECK_OK(es_scene_arrays_init(&arrays, sizeof arrays));
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "no triangles", es_scene_extent(scene, 0.0, lower, upper));
    CHECK_OK(es_scene_check(scene, 0.0, &messages));
    CHECK_OK(es_messages_count(messages, &count));
    CHECK(count > 0);
    CHECK_OK(es_release(messages));
    const double point[3] = {0.0, 1.0, 0.0}, other[3] = {1.0, 1.0, 0.0};
    CHECK_OK(es_scene_add(scene, ES_SOURCES, point, NULL, 1, NULL));
    CHECK_OK(es_scene_add(scene, ES_LISTENERS, other, NULL, 1, NULL));
    es_simulation_options options = early_options(1);
    es_result result = 0;
    CHECK_FAILS(ES_ERROR_FAILED, "triangle", es_simulate(scene, &options, &result));
    CHECK_OK(es_release(scene));
}

/// Whether a message of es_scene_check() contains a text.
static int check_tells(es_scene scene, const char* text) {
    es_messages messages = 0;
    size_t count = 0;
    int found = 0;
    CHECK_OK(es_scene_check(scene, 0.0, &messages));
    CHECK_OK(es_messages_count(messages, &count));
    for (size_t i = 0; i < count; ++i) {
        const char *subject = NULL, *told = NULL;
        CHECK_OK(es_messages_get(messages, i, &subject, &told));
        found = found || strstr(told, text) != NULL;
    }
    CHECK_OK(es_release(messages));
    return found;
}

static void test_coincident_materials(void) {
    // A square of "wood" whose half of 2 m2 is "wool", too.
    const double vertices[] = {0, 0, 0, 2, 0, 0, 2, 0, 2, 0, 0, 2};
    const uint32_t triangles[] = {0, 2, 1, 0, 3, 2, 0, 2, 1};
    uint32_t materials[] = {0, 0, 1};
    const char* names[] = {"wood", "wool"};
    es_scene_arrays arrays;
    es_scene scene = 0;
    CHECK_OK(es_scene_arrays_init(&arrays, sizeof arrays));
    arrays.vertices = vertices;
    arrays.vertex_count = 4;
    arrays.triangles = triangles;
    arrays.triangle_count = 3;
    arrays.material_of_triangle = materials;
    arrays.material_names = names;
    arrays.material_count = 2;
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK(check_tells(scene, "materials wood and wool lie in one place over 2 m2"));
    CHECK_OK(es_release(scene));
    materials[2] = 0;
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK(!check_tells(scene, "lie in one place"));
    CHECK_OK(es_release(scene));
    // What no simulation takes is told, and is no failure of the check: triangles without area.
    const uint32_t lines[] = {0, 1, 1};
    arrays.triangles = lines;
    arrays.triangle_count = 1;
    CHECK_OK(es_scene_create(&arrays, &scene));
    CHECK(check_tells(scene, "area"));
    CHECK_OK(es_release(scene));
}

static double floor_area(const double* corners, size_t count) {
    es_scene scene = 0;
    CHECK_OK(es_scene_create_extruded(corners, count, 2.5, &scene));
    const uint32_t *triangles = NULL, *materials = NULL;
    size_t triangle_count = 0, vertex_count = 0;
    double positions[64 * 3];
    CHECK_OK(es_scene_triangles(scene, &triangles, &materials, NULL, &triangle_count));
    CHECK_OK(es_scene_count(scene, ES_VERTICES, &vertex_count));
    CHECK(vertex_count == 2 * count);
    CHECK(triangle_count == 2 * (count - 2) + 2 * count);
    CHECK_OK(es_scene_positions(scene, 0.0, positions, vertex_count));
    double area = 0.0;
    for (size_t i = 0; i < triangle_count; ++i) {
        const double* a = positions + 3 * triangles[3 * i];
        const double* b = positions + 3 * triangles[3 * i + 1];
        const double* c = positions + 3 * triangles[3 * i + 2];
        if (materials[i] == 0) {  // of the floor, seen from above: x to the right, z downwards
            area -= 0.5 * ((b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0]));
        }
    }
    CHECK_OK(es_release(scene));
    return area;
}

static void test_extruded(void) {
    // An L of 6 x 4 m without its corner of 2 x 1 m, in both senses of rotation: 22 m2.
    const double one_way[] = {0, 0, 6, 0, 6, 3, 4, 3, 4, 4, 0, 4};
    const double other_way[] = {0, 4, 4, 4, 4, 3, 6, 3, 6, 0, 0, 0};
    CHECK_NEAR(floor_area(one_way, 6), 22.0, 1e-12);
    CHECK_NEAR(floor_area(other_way, 6), 22.0, 1e-12);

    // The direct sound and one reflection from each of eight surfaces that see both points.
    es_scene scene = 0;
    const char* name = NULL;
    CHECK_OK(es_scene_create_extruded(one_way, 6, 2.5, &scene));
    CHECK_OK(es_scene_item_name(scene, ES_MATERIALS, 7, &name));
    CHECK_TEXT(name, "wall 5");
    CHECK_OK(es_release(scene));

    const double crossing[] = {0, 0, 2, 2, 2, 0, 0, 2};
    const double touching[] = {0, 0, 4, 0, 4, 4, 2, 0, 0, 4};
    const double spike[] = {0, 0, 4, 0, 2, 0, 2, 2};
    const double twice[] = {0, 0, 0, 0, 4, 0, 4, 4};
    const double line[] = {0, 0, 1, 0, 2, 0};
    const double not_a_number[] = {0, 0, NAN, 0, 4, 4};
    CHECK_FAILS(ES_ERROR_FAILED, "wall", es_scene_create_extruded(crossing, 4, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "wall", es_scene_create_extruded(touching, 5, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "wall", es_scene_create_extruded(spike, 4, 2.5, &scene));
    CHECK_FAILS(
        ES_ERROR_FAILED, "corners 0 and 1", es_scene_create_extruded(twice, 4, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "wall", es_scene_create_extruded(line, 3, 2.5, &scene));
    CHECK_FAILS(
        ES_ERROR_FAILED, "corner 1", es_scene_create_extruded(not_a_number, 3, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "2 corners", es_scene_create_extruded(one_way, 2, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "height", es_scene_create_extruded(one_way, 6, 0.0, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "height", es_scene_create_extruded(one_way, 6, NAN, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "corners", es_scene_create_extruded(NULL, 6, 2.5, &scene));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "corners", es_scene_create_extruded(one_way, SIZE_MAX, 2.5, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "scene", es_scene_create_extruded(one_way, 6, 2.5, NULL));
}

static void test_shoebox(void) {
    es_scene scene = 0;
    const double flat[3] = {5.0, 0.0, 4.0}, infinite[3] = {5.0, INFINITY, 4.0}, good[3] = {5, 3, 4};
    CHECK_FAILS(ES_ERROR_FAILED, "size", es_scene_create_shoebox(flat, &scene));
    CHECK_FAILS(ES_ERROR_FAILED, "size", es_scene_create_shoebox(infinite, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "size", es_scene_create_shoebox(NULL, &scene));
    CHECK_FAILS(ES_ERROR_NULL, "scene", es_scene_create_shoebox(good, NULL));
}

void test_scene_arrays(void) {
    test_arrays();
    test_coincident_materials();
    test_extruded();
    test_shoebox();
}
