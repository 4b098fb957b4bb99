// SPDX-License-Identifier: MIT
// Checks of the C tests: what fails is printed, and the program ends.
#ifndef EARSHOT_TESTS_CAPI_CHECK_H
#define EARSHOT_TESTS_CAPI_CHECK_H

#include "earshot.h"
#include <stddef.h>
#include <stdint.h>

#define CHECK(condition) check((condition) != 0, #condition, __FILE__, __LINE__)
#define CHECK_NEAR(value, expected, tolerance) \
    check_near((value), (expected), (tolerance), #value, __FILE__, __LINE__)
#define CHECK_TEXT(value, expected) check_text((value), (expected), #value, __FILE__, __LINE__)
/// The call succeeds.
#define CHECK_OK(call) check_ok((call), #call, __FILE__, __LINE__)
/// The call fails with that status, and its message contains the text.
#define CHECK_FAILS(status, text, call) \
    check_fails((status), (text), (call), #call, __FILE__, __LINE__)

void check(int holds, const char* what, const char* file, int line);
void check_near(
    double value, double expected, double tolerance, const char* what, const char* file, int line);
void check_text(
    const char* value, const char* expected, const char* what, const char* file, int line);
void check_ok(es_status status, const char* what, const char* file, int line);
void check_fails(es_status expected,
                 const char* text,
                 es_status status,
                 const char* what,
                 const char* file,
                 int line);

/// A path below the project's folder; valid until the next call.
const char* project_file(const char* name);

/// A shoe-box of 5 x 3 x 4 m whose walls absorb `absorption` and do not scatter, with a source at
/// 1, 1.2, 1.5 and a listener at 3.5, 1.7, 2.5.
es_scene make_room(double absorption);
/// The defaults, but of order `order` and without rays.
es_simulation_options early_options(int32_t order);

/// Groups of tests.
void test_errors(void);
void test_handles(void);
void test_scenes(void);
void test_scene_arrays(void);
void test_materials(void);
void test_emitters(void);
void test_simulation(void);
void test_simulation_options(void);
void test_results(void);
void test_result_errors(void);
void test_reports(void);
void test_sounds(void);
void test_path_sounds(void);
void test_bvh(void);
void test_sight(void);
void test_worlds(void);
void test_world_errors(void);
void test_visible_sets(void);
void test_maps(void);
void test_calibrations(void);
void test_simplifications(void);
void test_locations(void);
void test_checks(void);
void test_engines(void);
void test_without_module(void);
void test_threads(void);

#endif
