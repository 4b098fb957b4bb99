// SPDX-License-Identifier: MIT
// Worlds: contacts, distances, depths of meshes that move.
#include "check.h"
#include <math.h>
#include <string.h>

static const double kFloor[] = {-4, 0, -4, -4, 0, 4, 4, 0, 4, 4, 0, -4};
static const uint32_t kFloorFaces[] = {0, 1, 2, 0, 2, 3};
static const uint32_t kTetrahedron[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

/// A tetrahedron that stands on its tip at height y.
static void tetrahedron_at(double y, double vertices[12]) {
    const double shape[] = {-1, 2, -1, 1, 2, -1, 0, 2, 1, 0, 0, 0};
    for (int i = 0; i < 12; ++i) {
        vertices[i] = shape[i] + (i % 3 == 1 ? y : 0.0);
    }
}

static es_world make_world(uint32_t* floor, uint32_t* solid) {
    es_world world = 0;
    double vertices[12];
    tetrahedron_at(1.0, vertices);
    CHECK_OK(es_world_create(&world));
    CHECK_OK(es_world_add_mesh(world, "floor", kFloor, 4, kFloorFaces, 2, floor));
    CHECK_OK(es_world_add_mesh(world, NULL, vertices, 4, kTetrahedron, 4, solid));
    CHECK(*floor == 0 && *solid == 1);
    return world;
}

static void test_contacts(void) {
    uint32_t floor = 9, solid = 9;
    es_world world = make_world(&floor, &solid);
    size_t count = 99;
    const char* name = NULL;
    CHECK_OK(es_world_mesh_count(world, &count));
    CHECK(count == 2);
    CHECK_OK(es_world_mesh_name(world, floor, &name));
    CHECK_TEXT(name, "floor");
    CHECK_OK(es_world_mesh_name(world, solid, &name));
    CHECK_TEXT(name, "");

    // At rest nothing touches, and the tip is 1 m above the floor.
    es_contacts contacts = 0;
    const es_contact* array = NULL;
    CHECK_OK(es_world_contacts(world, NULL, &contacts));
    CHECK_OK(es_contacts_get(contacts, &array, &count));
    CHECK(count == 0);
    CHECK_OK(es_release(contacts));
    es_distance distance;
    CHECK_OK(es_world_distance(world, floor, solid, 1, &distance));
    CHECK_NEAR(distance.distance, 1.0, 1e-12);
    CHECK_NEAR(distance.on_b[1], 1.0, 1e-12);
    CHECK(distance.triangle_a < 2 && distance.triangle_b < 4);

    // It falls by 4 m: the tip touches the floor after a quarter of the step.
    double begin[12], end[12];
    tetrahedron_at(1.0, begin);
    tetrahedron_at(-3.0, end);
    CHECK_OK(es_world_step_mesh(world, solid, begin, end, 4));
    CHECK_OK(es_world_contacts(world, NULL, &contacts));
    CHECK_OK(es_contacts_get(contacts, &array, &count));
    CHECK(count > 0);
    for (size_t i = 1; i < count; ++i) {
        CHECK(array[i].toi >= array[i - 1].toi);
    }
    CHECK(array[0].kind == ES_CONTACT_VERTEX_FACE);
    CHECK(array[0].toi <= 0.25);
    CHECK_NEAR(array[0].toi, 0.25, 1e-9);
    CHECK(array[0].a.mesh == solid && array[0].a.vertex_count == 1 && array[0].a.vertices[0] == 3);
    CHECK(array[0].b.mesh == floor && array[0].b.vertex_count == 3);
    CHECK_NEAR(fabs(array[0].normal[1]), 1.0, 1e-12);
    CHECK_NEAR(array[0].point[0], 0.0, 1e-12);

    // The first alone, and what options leave over.
    es_contact first;
    int32_t found = 9;
    CHECK_OK(es_world_first_contact(world, NULL, &first, &found));
    CHECK(found == 1 && memcmp(&first, &array[0], sizeof first) == 0);
    CHECK_OK(es_release(contacts));
    es_contact_options options;
    CHECK_OK(es_contact_options_init(&options, sizeof options));
    options.moving_only = 1;
    CHECK_OK(es_world_first_contact(world, &options, &first, &found));
    CHECK(found == 1);
    const uint32_t pairs[] = {1, 0}, others[] = {0, 0};
    options.pairs = pairs;
    options.pair_count = 1;
    CHECK_OK(es_world_first_contact(world, &options, &first, &found));
    CHECK(found == 1);
    options.pairs = others;
    CHECK_OK(es_world_first_contact(world, &options, &first, &found));
    CHECK(found == 0);
    options.pairs = NULL;
    options.pair_count = 0;
    options.between_meshes = 0;
    CHECK_OK(es_world_first_contact(world, &options, &first, &found));
    CHECK(found == 0);
    options.between_meshes = 1;
    options.min_separation = 0.5;
    CHECK_OK(es_world_first_contact(world, &options, &first, &found));
    CHECK(found == 1 && first.toi < 0.126 && first.toi > 0.12);  // 0.5 m above the floor

    // Where it has gone through, triangles intersect.
    CHECK_OK(es_world_step_mesh(world, solid, end, NULL, 4));
    tetrahedron_at(-1.0, begin);
    CHECK_OK(es_world_step_mesh(world, solid, begin, NULL, 4));
    CHECK_OK(es_world_intersections(world, NULL, &contacts));
    CHECK_OK(es_contacts_get(contacts, &array, &count));
    CHECK(count > 0 && array[0].kind == ES_CONTACT_TRIANGLE_TRIANGLE && array[0].toi == 0.0);
    CHECK_OK(es_release(contacts));
    CHECK_OK(es_world_distance(world, floor, solid, 1, &distance));
    CHECK(distance.distance == 0.0 && distance.triangle_a == ES_NONE);

    // A mesh that was removed meets nothing.
    CHECK_OK(es_world_remove_mesh(world, floor));
    CHECK_OK(es_world_first_contact(world, NULL, &first, &found));
    CHECK(found == 0);
    CHECK_OK(es_world_mesh_count(world, &count));
    CHECK(count == 2);
    CHECK_FAILS(ES_ERROR_INDEX, "removed", es_world_remove_mesh(world, floor));
    CHECK_FAILS(ES_ERROR_INDEX, "removed", es_world_distance(world, floor, solid, 1, &distance));
    CHECK_FAILS(ES_ERROR_INDEX, "removed", es_world_step_mesh(world, floor, kFloor, NULL, 4));
    CHECK_OK(es_release(world));
}

static void test_screws_and_depths(void) {
    // Two tetrahedra tip to base; one slides into the other's tip.
    uint32_t floor = 0, solid = 0, other = 0;
    es_world world = make_world(&floor, &solid);
    double vertices[12];
    tetrahedron_at(2.5, vertices);  // its tip is 0.5 m below the base of the other
    CHECK_OK(es_world_add_mesh(world, "other", vertices, 4, kTetrahedron, 4, &other));
    es_depth depth;
    CHECK_OK(es_world_depth(world, solid, other, &depth));
    CHECK(depth.overlap == 1);
    CHECK(depth.depth > 0.0 && depth.depth <= 0.5 + 1e-12);
    CHECK_NEAR(sqrt(pow(depth.move[0], 2) + pow(depth.move[1], 2) + pow(depth.move[2], 2)),
               depth.depth,
               1e-12);
    CHECK_OK(es_world_depth(world, floor, other, &depth));
    CHECK(depth.overlap == 0);  // the floor is no solid
    CHECK_FAILS(ES_ERROR_NULL, "depth", es_world_depth(world, solid, other, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "b", es_world_depth(world, solid, 3, &depth));

    // It turns about the y axis through its tip and slides down by 2 m: the tip touches half way.
    tetrahedron_at(1.0, vertices);
    const double point[] = {0, 0, 0}, axis[] = {0, 5, 0}, none[] = {0, 0, 0};
    es_contact first;
    int32_t found = 0;
    CHECK_OK(es_world_remove_mesh(world, other));
    CHECK_OK(es_world_step_screw(world, solid, vertices, 4, point, axis, 3.0, -2.0));
    CHECK_OK(es_world_first_contact(world, NULL, &first, &found));
    CHECK(found == 1);
    CHECK(first.toi <= 0.5 && first.toi > 0.4999);
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "axis",
                es_world_step_screw(world, solid, vertices, 4, point, none, 1.0, 0.0));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "angle",
                es_world_step_screw(world, solid, vertices, 4, point, axis, NAN, 0.0));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "slide",
                es_world_step_screw(world, solid, vertices, 4, point, axis, 1.0, INFINITY));
    CHECK_FAILS(ES_ERROR_NULL,
                "point",
                es_world_step_screw(world, solid, vertices, 4, NULL, axis, 1.0, 0.0));
    CHECK_FAILS(ES_ERROR_NULL,
                "axis",
                es_world_step_screw(world, solid, vertices, 4, point, NULL, 1.0, 0.0));
    CHECK_FAILS(
        ES_ERROR_NULL, "begin", es_world_step_screw(world, solid, NULL, 4, point, axis, 1.0, 0.0));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "vertex_count",
                es_world_step_screw(world, solid, vertices, 3, point, axis, 1.0, 0.0));
    CHECK_OK(es_release(world));
}

static void test_scene(void) {
    // The leaf of the door keeps 10 mm of its frame while it opens.
    es_scene scene = 0;
    es_world world = 0;
    uint32_t first = 9;
    CHECK_OK(es_scene_load(project_file("scenes/door.gltf"), NULL, &scene));
    CHECK_OK(es_world_create(&world));
    CHECK_OK(es_world_add_scene(world, scene, 1, &first));
    CHECK(first == 0);
    size_t meshes = 0, in_scene = 0;
    CHECK_OK(es_world_mesh_count(world, &meshes));
    CHECK_OK(es_scene_count(scene, ES_MESHES, &in_scene));
    CHECK(meshes == in_scene);
    CHECK_OK(es_release(scene));
    CHECK_OK(es_world_set_time_step(world, 0.0, 0.5, 1));
    es_contact_options options;
    es_contact contact;
    int32_t found = 9;
    CHECK_OK(es_contact_options_init(&options, sizeof options));
    options.moving_only = 1;
    CHECK_OK(es_world_first_contact(world, &options, &contact, &found));
    CHECK(found == 0);
    options.min_separation = 0.05;
    CHECK_OK(es_world_first_contact(world, &options, &contact, &found));
    CHECK(found == 1);
    CHECK_OK(es_world_set_time_step(world, 0.5, 0.5, 0));
    CHECK_OK(es_world_first_contact(world, &options, &contact, &found));
    CHECK(found == 0);  // nothing moves
    const double point[3] = {0, 0, 0};
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "a mesh of a scene", es_world_step_mesh(world, 0, point, NULL, 1));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "t0", es_world_set_time_step(world, NAN, 0.5, 0));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "t1", es_world_set_time_step(world, 0.0, INFINITY, 0));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "rigid", es_world_set_time_step(world, 0.0, 0.5, 2));
    CHECK_OK(es_release(world));
}

void test_worlds(void) {
    test_contacts();
    test_screws_and_depths();
    test_scene();
}

void test_world_errors(void) {
    uint32_t floor = 0, solid = 0, mesh = 0;
    es_world world = make_world(&floor, &solid);
    const uint32_t beyond[] = {0, 1, 4};
    const double nan[] = {0, NAN, 0};
    double vertices[12];
    tetrahedron_at(0.0, vertices);
    CHECK_FAILS(ES_ERROR_NULL, "world", es_world_create(NULL));
    CHECK_FAILS(ES_ERROR_INDEX,
                "triangles[0]",
                es_world_add_mesh(world, "", vertices, 4, beyond, 1, &mesh));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "vertices[0]", es_world_add_mesh(world, "", nan, 1, NULL, 0, &mesh));
    CHECK_FAILS(
        ES_ERROR_NULL, "vertices", es_world_add_mesh(world, "", NULL, 4, kTetrahedron, 4, &mesh));
    CHECK_FAILS(
        ES_ERROR_NULL, "triangles", es_world_add_mesh(world, "", vertices, 4, NULL, 4, &mesh));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "triangles",
                es_world_add_mesh(world, "", vertices, 4, kTetrahedron, SIZE_MAX, &mesh));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "name",
                es_world_add_mesh(world, "\xff", vertices, 4, kTetrahedron, 4, &mesh));
    CHECK_FAILS(
        ES_ERROR_NULL, "mesh", es_world_add_mesh(world, "", vertices, 4, kTetrahedron, 4, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "scene", es_world_add_scene(world, world, 1, &mesh));
    es_scene scene = make_room(0.5);
    CHECK_FAILS(ES_ERROR_ARGUMENT, "weld", es_world_add_scene(world, scene, 2, &mesh));
    CHECK_FAILS(ES_ERROR_NULL, "first", es_world_add_scene(world, scene, 1, NULL));
    CHECK_OK(es_release(scene));
    CHECK_FAILS(ES_ERROR_INDEX, "mesh", es_world_remove_mesh(world, 2));
    const char* name = NULL;
    CHECK_FAILS(ES_ERROR_INDEX, "mesh", es_world_mesh_name(world, 2, &name));
    CHECK_FAILS(ES_ERROR_NULL, "name", es_world_mesh_name(world, 0, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_world_mesh_count(world, NULL));
    CHECK_FAILS(ES_ERROR_INDEX, "mesh", es_world_step_mesh(world, ES_NONE, vertices, NULL, 4));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "vertex_count", es_world_step_mesh(world, solid, vertices, NULL, 5));
    CHECK_FAILS(ES_ERROR_NULL, "begin", es_world_step_mesh(world, solid, NULL, vertices, 4));
    vertices[1] = NAN;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "begin[0]", es_world_step_mesh(world, solid, vertices, NULL, 4));

    es_contact_options options;
    es_contacts contacts = 0;
    es_contact contact;
    int32_t found = 0;
    CHECK_OK(es_contact_options_init(&options, sizeof options));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_contact_options_init(&options, 0));
    options.threads = -1;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_world_contacts(world, &options, &contacts));
    options.threads = 1;
    options.within_meshes = 3;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "within_meshes", es_world_contacts(world, &options, &contacts));
    options.within_meshes = 1;
    options.between_meshes = -1;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "between_meshes", es_world_contacts(world, &options, &contacts));
    options.between_meshes = 1;
    options.moving_only = 2;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "moving_only", es_world_contacts(world, &options, &contacts));
    options.moving_only = 0;
    options.min_separation = NAN;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "min_separation", es_world_contacts(world, &options, &contacts));
    options.min_separation = 0.1;
    options.tolerance = 0.0;
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "tolerance", es_world_first_contact(world, &options, &contact, &found));
    options.tolerance = 1e-6;
    options.pair_count = 1;
    CHECK_FAILS(ES_ERROR_NULL, "pairs", es_world_contacts(world, &options, &contacts));
    const uint32_t pairs[] = {0, 2};
    options.pairs = pairs;
    CHECK_FAILS(ES_ERROR_INDEX, "pairs", es_world_intersections(world, &options, &contacts));
    options.struct_size = 5;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "struct_size", es_world_contacts(world, &options, &contacts));
    CHECK_FAILS(ES_ERROR_NULL, "contacts", es_world_contacts(world, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "contacts", es_world_intersections(world, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "contact", es_world_first_contact(world, NULL, NULL, &found));
    CHECK_FAILS(ES_ERROR_NULL, "found", es_world_first_contact(world, NULL, &contact, NULL));
    es_distance distance;
    CHECK_FAILS(ES_ERROR_INDEX, "a", es_world_distance(world, 2, 0, 1, &distance));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_world_distance(world, 0, 1, -1, &distance));
    CHECK_FAILS(ES_ERROR_NULL, "distance", es_world_distance(world, 0, 1, 1, NULL));
    CHECK_OK(es_world_contacts(world, NULL, &contacts));
    const es_contact* array = NULL;
    size_t count = 0;
    CHECK_FAILS(ES_ERROR_NULL, "array", es_contacts_get(contacts, NULL, &count));
    CHECK_FAILS(ES_ERROR_NULL, "count", es_contacts_get(contacts, &array, NULL));
    CHECK_FAILS(ES_ERROR_HANDLE, "contacts", es_contacts_get(world, &array, &count));
    CHECK_OK(es_release(contacts));
    CHECK_OK(es_release(world));
}
