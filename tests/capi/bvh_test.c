// SPDX-License-Identifier: MIT
// The hierarchy: rays, closest points, lines of sight, meshes that move.
#include "check.h"
#include <math.h>

// Two walls across the x axis, at x = 1 and x = 2, 2 m wide and high.
static const double kWalls[] = {1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1,
                                2, -1, -1, 2, 1, -1, 2, 1, 1, 2, -1, 1};
static const uint32_t kFaces[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};

static es_bvh make_walls(int32_t builder) {
    es_bvh bvh = 0;
    CHECK_OK(es_bvh_create(kWalls, 8, kFaces, 4, builder, 1, &bvh));
    CHECK(es_kind_of(bvh) == ES_KIND_BVH);
    return bvh;
}

static void test_rays(void) {
    // Along +x at half a metre from both edges, against -x, past the walls, and too short.
    const double origins[] = {0, 0.5, 0.25, 3, 0.5, 0.25, 0, 5, 0, 0, 0.5, 0.25};
    const double directions[] = {1, 0, 0, -0.5, 0, 0, 1, 0, 0, 1, 0, 0};
    const double max_t[] = {INFINITY, INFINITY, INFINITY, 0.5};
    for (int32_t builder = ES_BUILDER_BINNED_SAH; builder <= ES_BUILDER_FAST; ++builder) {
        es_bvh bvh = make_walls(builder);
        double t[4], uv[8];
        uint32_t triangles[4];
        CHECK_OK(es_bvh_closest_hits(bvh, origins, directions, max_t, 4, 1, t, triangles, uv));
        CHECK(triangles[0] == 0 && triangles[1] == 2);
        CHECK(triangles[2] == ES_NONE && triangles[3] == ES_NONE);
        CHECK_NEAR(t[0], 1.0, 0.0);
        CHECK_NEAR(t[1], 2.0, 0.0);  // in multiples of the direction
        CHECK(isinf(t[2]) && isinf(t[3]));
        // The point is 0.125 a + u b + v c of triangle 0: y = -1 + 2 (u + v), z = -1 + 2 v.
        CHECK_NEAR(uv[1], 0.625, 1e-15);
        CHECK_NEAR(uv[0], 0.125, 1e-15);
        CHECK_OK(es_bvh_closest_hits(bvh, origins, directions, NULL, 4, 2, t, NULL, NULL));
        CHECK_NEAR(t[3], 1.0, 0.0);
        CHECK_OK(es_release(bvh));
    }

    es_bvh bvh = make_walls(0);
    double t[1];
    const double none[] = {0, 0, 0}, nan[] = {0, NAN, 0}, huge[] = {1e300, 0, 0},
                 negative[] = {-1.0};
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "directions[0]",
                es_bvh_closest_hits(bvh, origins, none, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "directions[0]",
                es_bvh_closest_hits(bvh, origins, huge, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "directions[1]",
                es_bvh_closest_hits(bvh, origins, nan, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "origins[0]",
                es_bvh_closest_hits(bvh, nan, origins, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "max_t[0]",
                es_bvh_closest_hits(bvh, origins, directions, negative, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "max_t[0]",
                es_bvh_closest_hits(bvh, origins, directions, nan + 1, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL,
                "origins",
                es_bvh_closest_hits(bvh, NULL, directions, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL,
                "directions",
                es_bvh_closest_hits(bvh, origins, NULL, NULL, 1, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "origins",
                es_bvh_closest_hits(bvh, origins, directions, NULL, SIZE_MAX, 1, t, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "threads",
                es_bvh_closest_hits(bvh, origins, directions, NULL, 1, -1, t, NULL, NULL));
    CHECK_OK(es_bvh_closest_hits(bvh, NULL, NULL, NULL, 0, 1, NULL, NULL, NULL));

    uint8_t occluded[2] = {7, 7};
    const double from[] = {0, 0, 0, 0, 5, 0}, to[] = {1, 0, 0, 3, 5, 0};
    CHECK_OK(es_bvh_occluded(bvh, from, to, 2, 1, occluded));
    CHECK(occluded[0] == 1 && occluded[1] == 0);  // the first ends on the wall
    CHECK_FAILS(ES_ERROR_NULL, "occluded", es_bvh_occluded(bvh, from, to, 2, 1, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "to", es_bvh_occluded(bvh, from, NULL, 2, 1, occluded));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "from", es_bvh_occluded(bvh, nan, to, 1, 1, occluded));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "", es_bvh_occluded(bvh, from, to, SIZE_MAX, 1, occluded));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_bvh_occluded(bvh, from, to, 1, 1025, occluded));
    CHECK_OK(es_release(bvh));
}

static void test_closest_points(void) {
    es_bvh bvh = make_walls(0);
    const double points[] = {0.25, 0, 0, 4, 4, 5};
    double distances[2], closest[6];
    uint32_t triangles[2];
    CHECK_OK(es_bvh_closest_points(bvh, points, 2, INFINITY, 1, distances, triangles, closest));
    CHECK_NEAR(distances[0], 0.75, 1e-15);
    CHECK_NEAR(distances[1], sqrt(4 + 9 + 16), 1e-14);  // from the corner 2, 1, 1
    CHECK(triangles[0] == 0 && triangles[1] == 2);
    CHECK_NEAR(closest[0], 1.0, 0.0);
    CHECK_NEAR(closest[5], 1.0, 0.0);
    CHECK_OK(es_bvh_closest_points(bvh, points, 2, 1.0, 1, distances, triangles, closest));
    CHECK(triangles[0] == 0 && triangles[1] == ES_NONE && isinf(distances[1]) && isnan(closest[3]));
    CHECK_OK(es_bvh_closest_points(bvh, points, 2, 1.0, 1, NULL, NULL, NULL));
    const double nan[] = {0, NAN, 0};
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "points[0]",
                es_bvh_closest_points(bvh, nan, 1, 1.0, 1, distances, NULL, NULL));
    CHECK_FAILS(ES_ERROR_NULL,
                "points",
                es_bvh_closest_points(bvh, NULL, 1, 1.0, 1, distances, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "max_distance",
                es_bvh_closest_points(bvh, points, 1, NAN, 1, distances, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "max_distance",
                es_bvh_closest_points(bvh, points, 1, -1.0, 1, distances, NULL, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "threads",
                es_bvh_closest_points(bvh, points, 1, 1.0, -1, distances, NULL, NULL));
    CHECK_OK(es_release(bvh));
}

static void test_updates(void) {
    es_bvh bvh = make_walls(0);
    double moved[24];
    const double origin[] = {0, 0.5, 0.25}, direction[] = {1, 0, 0};
    double t = 0.0, distance = 0.0;
    int32_t action = 9;
    CHECK_OK(es_bvh_closest_points(bvh, origin, 1, INFINITY, 1, &distance, NULL, NULL));
    CHECK_NEAR(distance, 1.0, 0.0);
    for (int step = 1; step <= 20; ++step) {
        for (int i = 0; i < 24; ++i) {
            moved[i] = kWalls[i] + (i % 3 == 0 ? 0.5 * step : 0.0);
        }
        CHECK_OK(es_bvh_update(bvh, moved, 8, step % 2 == 0 ? 1e6 : 0.0, 1, &action));
        CHECK(action >= ES_UPDATE_REFIT && action <= ES_UPDATE_REBUILD);
        CHECK(step % 2 == 0 || action == ES_UPDATE_REFIT);
        CHECK_OK(es_bvh_closest_hits(bvh, origin, direction, NULL, 1, 1, &t, NULL, NULL));
        CHECK_NEAR(t, 1.0 + 0.5 * step, 1e-15);
        CHECK_OK(es_bvh_closest_points(bvh, origin, 1, INFINITY, 1, &distance, NULL, NULL));
        CHECK_NEAR(distance, 1.0 + 0.5 * step, 1e-14);
    }
    size_t vertices = 0, triangles = 0;
    CHECK_OK(es_bvh_counts(bvh, &vertices, &triangles));
    CHECK(vertices == 8 && triangles == 4);
    CHECK_OK(es_bvh_counts(bvh, NULL, NULL));
    CHECK_OK(es_bvh_update(bvh, moved, 8, 0.0, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "vertex_count", es_bvh_update(bvh, moved, 7, 0.0, 1, NULL));
    CHECK_FAILS(ES_ERROR_NULL, "vertices", es_bvh_update(bvh, NULL, 8, 0.0, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "expected_queries", es_bvh_update(bvh, moved, 8, NAN, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_bvh_update(bvh, moved, 8, 0.0, -1, NULL));
    moved[5] = NAN;
    CHECK_FAILS(ES_ERROR_ARGUMENT, "vertices[1]", es_bvh_update(bvh, moved, 8, 0.0, 1, NULL));
    CHECK_OK(es_release(bvh));
}

static void test_making(void) {
    es_bvh bvh = 0;
    const uint32_t wrong[] = {0, 1, 8};
    CHECK_FAILS(ES_ERROR_INDEX, "triangles[0]", es_bvh_create(kWalls, 8, wrong, 1, 0, 1, &bvh));
    CHECK_FAILS(ES_ERROR_NULL, "vertices", es_bvh_create(NULL, 8, kFaces, 1, 0, 1, &bvh));
    CHECK_FAILS(ES_ERROR_NULL, "triangles", es_bvh_create(kWalls, 8, NULL, 1, 0, 1, &bvh));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "vertices", es_bvh_create(kWalls, SIZE_MAX, kFaces, 1, 0, 1, &bvh));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "triangles", es_bvh_create(kWalls, 8, kFaces, SIZE_MAX, 0, 1, &bvh));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "builder", es_bvh_create(kWalls, 8, kFaces, 4, 7, 1, &bvh));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_bvh_create(kWalls, 8, kFaces, 4, 0, 5000, &bvh));
    CHECK_FAILS(ES_ERROR_NULL, "bvh", es_bvh_create(kWalls, 8, kFaces, 4, 0, 1, NULL));

    // Nothing is hit where nothing is.
    double t = 0.0;
    uint32_t triangle = 0;
    const double origin[] = {0, 0, 0}, direction[] = {1, 0, 0};
    CHECK_OK(es_bvh_create(NULL, 0, NULL, 0, 0, 1, &bvh));
    CHECK_OK(es_bvh_closest_hits(bvh, origin, direction, NULL, 1, 1, &t, &triangle, NULL));
    CHECK(isinf(t) && triangle == ES_NONE);
    CHECK_OK(es_bvh_closest_points(bvh, origin, 1, INFINITY, 1, &t, &triangle, NULL));
    CHECK(isinf(t) && triangle == ES_NONE);
    CHECK_OK(es_release(bvh));

    es_scene scene = make_room(0.5);
    size_t triangles = 0;
    CHECK_OK(es_bvh_create_from_scene(scene, 0.0, ES_BUILDER_QUALITY, 1, &bvh));
    CHECK_OK(es_bvh_counts(bvh, NULL, &triangles));
    CHECK(triangles == 12);
    CHECK_OK(es_release(bvh));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "time", es_bvh_create_from_scene(scene, NAN, 0, 1, &bvh));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "builder", es_bvh_create_from_scene(scene, 0.0, -1, 1, &bvh));
    CHECK_FAILS(ES_ERROR_NULL, "bvh", es_bvh_create_from_scene(scene, 0.0, 0, 1, NULL));
    CHECK_OK(es_release(scene));
}

void test_bvh(void) {
    test_rays();
    test_closest_points();
    test_updates();
    test_making();
}

enum { kMany = 20000 };

// Along +x at heights that rise to 2 m: those up to 1 m are blocked. Of ends far apart that are no
// points the first is told, whatever the number of threads, and nothing is written.
static void test_many_segments(void) {
    es_bvh bvh = make_walls(0);
    static double from[3 * kMany], to[3 * kMany];
    static uint8_t visible[kMany], blocked[kMany];
    static uint32_t blockers[kMany];
    for (int i = 0; i < kMany; ++i) {
        from[3 * i + 1] = to[3 * i + 1] = 2.0 * i / kMany;
        from[3 * i + 2] = to[3 * i + 2] = 0.25;
        to[3 * i] = 1.5;
    }
    for (int32_t threads = 1; threads <= 3; ++threads) {
        CHECK_OK(es_bvh_visible(bvh, from, to, kMany, threads, visible));
        CHECK_OK(es_bvh_occluded(bvh, from, to, kMany, threads, blocked));
        CHECK_OK(es_bvh_first_blockers(bvh, from, to, kMany, threads, blockers, NULL));
        for (int i = 0; i < kMany; ++i) {
            const int expected = 2 * i > kMany;
            CHECK(visible[i] == expected && blocked[i] == !expected);
            CHECK((blockers[i] == ES_NONE) == expected);
        }
    }
    to[3 * 9000] = from[3 * 15000 + 2] = from[3 * 19999] = NAN;
    for (int32_t threads = 1; threads <= 3; ++threads) {
        visible[0] = blocked[0] = 7;
        blockers[0] = 7;
        CHECK_FAILS(
            ES_ERROR_ARGUMENT, "to[9000]", es_bvh_visible(bvh, from, to, kMany, threads, visible));
        CHECK_FAILS(
            ES_ERROR_ARGUMENT, "to[9000]", es_bvh_occluded(bvh, from, to, kMany, threads, blocked));
        CHECK_FAILS(ES_ERROR_ARGUMENT,
                    "to[9000]",
                    es_bvh_first_blockers(bvh, from, to, kMany, threads, blockers, NULL));
        CHECK(visible[0] == 7 && blocked[0] == 7 && blockers[0] == 7);
    }
    CHECK_OK(es_release(bvh));
}

void test_sight(void) {
    test_many_segments();
    es_bvh bvh = make_walls(0);
    const double from[] = {0, 0, 0.5, 0, 5, 0, 0, 0, 0.5}, to[] = {3, 0, 0.5, 3, 5, 0, 1.5, 0, 0.5};
    uint8_t visible[3] = {7, 7, 7};
    uint32_t blockers[3];
    double t[3];
    CHECK_OK(es_bvh_visible(bvh, from, to, 3, 1, visible));
    CHECK(visible[0] == 0 && visible[1] == 1 && visible[2] == 0);
    CHECK_OK(es_bvh_first_blockers(bvh, from, to, 3, 2, blockers, t));
    CHECK(blockers[0] < 2 && blockers[1] == ES_NONE && blockers[2] < 2);
    CHECK_NEAR(t[0], 1.0 / 3.0, 1e-11);
    CHECK(isinf(t[1]));
    CHECK_NEAR(t[2], 2.0 / 3.0, 1e-11);
    CHECK_OK(es_bvh_first_blockers(bvh, from, to, 3, 1, blockers, NULL));

    // Without the first wall the second one blocks, and what ends before it is visible.
    const uint32_t first_wall[] = {0, 1};
    CHECK_OK(es_bvh_exclude(bvh, first_wall, 2));
    CHECK_OK(es_bvh_visible(bvh, from, to, 3, 1, visible));
    CHECK(visible[0] == 0 && visible[1] == 1 && visible[2] == 1);
    CHECK_OK(es_bvh_first_blockers(bvh, from, to, 1, 1, blockers, t));
    CHECK(blockers[0] == 2 || blockers[0] == 3);
    uint8_t matrix[6];
    CHECK_OK(es_bvh_visible_matrix(bvh, from, 2, to, 3, 1, matrix));
    CHECK(matrix[0] == 0 && matrix[2] == 1 && matrix[4] == 1);
    // Of balls that nothing covers all is seen, and nothing of one behind the second wall.
    double shares[6], errors[6];
    CHECK_OK(es_bvh_visible_shares(bvh, from, 2, to, 3, 0.01, 128, 1, shares, errors));
    CHECK(shares[0] == 0.0 && errors[0] == 0.0 && shares[2] == 1.0 && errors[2] == 0.0);
    CHECK_OK(es_bvh_visible_shares(bvh, from, 2, to, 3, 0.01, 128, 1, shares, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "radius",
                es_bvh_visible_shares(bvh, from, 2, to, 3, 0.0, 128, 1, shares, errors));
    CHECK_FAILS(ES_ERROR_ARGUMENT,
                "max_rays",
                es_bvh_visible_shares(bvh, from, 2, to, 3, 0.1, 7, 1, shares, errors));
    CHECK_FAILS(ES_ERROR_NULL,
                "shares",
                es_bvh_visible_shares(bvh, from, 2, to, 3, 0.1, 128, 1, NULL, errors));
    // Rays are not concerned.
    uint8_t occluded[3];
    CHECK_OK(es_bvh_occluded(bvh, from, to, 3, 1, occluded));
    CHECK(occluded[2] == 1);
    CHECK_OK(es_bvh_exclude(bvh, NULL, 0));
    CHECK_OK(es_bvh_visible(bvh, from, to, 3, 1, visible));
    CHECK(visible[2] == 0);

    const uint32_t beyond[] = {4};
    const double nan[] = {0, 0, NAN};
    CHECK_FAILS(ES_ERROR_INDEX, "triangles", es_bvh_exclude(bvh, beyond, 1));
    CHECK_FAILS(ES_ERROR_NULL, "triangles", es_bvh_exclude(bvh, NULL, 1));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "to[0]", es_bvh_visible(bvh, from, nan, 1, 1, visible));
    CHECK_FAILS(ES_ERROR_NULL, "from", es_bvh_visible(bvh, NULL, to, 1, 1, visible));
    CHECK_FAILS(ES_ERROR_NULL, "visible", es_bvh_visible(bvh, from, to, 1, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "threads", es_bvh_visible(bvh, from, to, 1, -1, visible));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "", es_bvh_visible(bvh, from, to, SIZE_MAX / 24, 1, visible));
    CHECK_FAILS(ES_ERROR_NULL, "triangles", es_bvh_first_blockers(bvh, from, to, 1, 1, NULL, t));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "from[0]", es_bvh_first_blockers(bvh, nan, to, 1, 1, blockers, t));
    CHECK_FAILS(ES_ERROR_NULL, "visible", es_bvh_visible_matrix(bvh, from, 2, to, 3, 1, NULL));
    CHECK_FAILS(ES_ERROR_ARGUMENT, "to[0]", es_bvh_visible_matrix(bvh, from, 2, nan, 1, 1, matrix));
    CHECK_FAILS(
        ES_ERROR_ARGUMENT, "threads", es_bvh_visible_matrix(bvh, from, 2, to, 3, 9999, matrix));
    CHECK_OK(es_bvh_visible_matrix(bvh, NULL, 0, NULL, 0, 1, NULL));
    CHECK_OK(es_release(bvh));
}
