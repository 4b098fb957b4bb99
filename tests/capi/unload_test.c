// SPDX-License-Identifier: MIT
// Loads the library as interpreters do, lets its threads work, closes it and goes on: PROGRAM
// LIBRARY.
#include "earshot.h"
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

typedef es_status (*create_shoebox)(const double*, es_scene*);
typedef es_status (*create_bvh)(es_scene, double, int32_t, int32_t, es_bvh*);
typedef es_status (*occluded)(es_bvh, const double*, const double*, size_t, int32_t, uint8_t*);

enum { kSegments = 100000 };

/// The function of that name; casts between pointers to objects and to functions are not C.
static void find(void* library, const char* name, void* function) {
    void* const symbol = dlsym(library, name);
    memcpy(function, &symbol, sizeof symbol);
}

int main(int argc, char** argv) {
    void* library = argc == 2 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (library == NULL) {
        fprintf(stderr, "cannot load the library: %s\n", dlerror());
        return 1;
    }
    create_shoebox make_room;
    create_bvh make_bvh;
    occluded ask;
    find(library, "es_scene_create_shoebox", &make_room);
    find(library, "es_bvh_create_from_scene", &make_bvh);
    find(library, "es_bvh_occluded", &ask);
    static double from[3 * kSegments], to[3 * kSegments];
    static uint8_t answers[kSegments];
    for (int i = 0; i < kSegments; ++i) {
        from[3 * i] = from[3 * i + 1] = from[3 * i + 2] = 1.0;
        to[3 * i] = 1e-5 * i * 8.0;  // beyond the wall at x = 5 m, in the end
        to[3 * i + 1] = to[3 * i + 2] = 2.0;
    }
    const double size[3] = {5.0, 3.0, 4.0};
    es_scene scene = 0;
    es_bvh bvh = 0;
    const int works = make_room(size, &scene) == ES_OK &&
                      make_bvh(scene, 0.0, 0, 4, &bvh) == ES_OK &&
                      ask(bvh, from, to, kSegments, 4, answers) == ES_OK;
    const int is_right = answers[1] == 0 && answers[kSegments - 1] == 1;
    dlclose(library);
    const struct timespec a_moment = {0, 200000000};
    nanosleep(&a_moment, NULL);  // in which threads of the library wake up
    return works && is_right ? 0 : 1;
}
