// SPDX-License-Identifier: MIT
#include "earshot.h"
#include <stdio.h>
#include <stdlib.h>

// Ends the program where a call fails.
static void must(es_status status) {
    if (status != ES_OK) {
        fprintf(stderr, "%s: %s\n", es_status_name(status), es_error_message());
        exit(1);
    }
}

// Prints where the work is; anything but 0 would stop it.
static int32_t show(void* user_data, const char* stage, uint64_t done, uint64_t total) {
    (void)user_data;
    fprintf(stderr, "\r%-12s%3.0f %%", stage, 100.0 * (double)done / (double)total);
    return 0;
}

int main(void) {
    // A classroom of 7.2 x 9 m, 3.2 m high, with a teacher and three seats.
    const double size[3] = {7.2, 3.2, 9.0};
    const double teacher[3] = {3.6, 1.6, 1.0};
    const double seats[] = {3.6, 1.2, 3.0, 2.0, 1.2, 5.5, 5.5, 1.2, 8.3};
    const char* names[] = {"front", "middle", "back"};
    es_scene room = 0;
    must(es_scene_create_shoebox(size, &room));
    must(es_scene_assign_library(room, "*", "plaster-on-brick", NULL));
    must(es_scene_assign_library(room, "floor", "carpet-thin", NULL));
    must(es_scene_assign_library(room, "ceiling", "acoustic-tile-suspended", NULL));
    must(es_scene_assign_library(room, "[es]*", "acoustic-plaster-25mm", NULL));  // east, south
    must(es_scene_add(room, ES_SOURCES, teacher, NULL, 1, NULL));
    must(es_scene_add(room, ES_LISTENERS, seats, names, 3, NULL));

    es_simulation_options options;
    must(es_simulation_options_init(&options, sizeof options));
    options.progress = show;
    es_result result = 0;
    must(es_simulate(room, &options, &result));

    fputc('\n', stderr);

    // (sources, listeners, channels, samples), one block, there until the result is released.
    const float* samples = NULL;
    size_t shape[4];
    must(es_result_responses(result, &samples, shape));

    const double *t30 = NULL, *sti = NULL;
    size_t of_metric[3];
    must(es_result_metric(
        result, ES_METRIC_T30, ES_EXPECTED, ES_SINGLE_NUMBER, &t30, NULL, of_metric));
    must(es_result_metric(
        result, ES_METRIC_STI, ES_EXPECTED, ES_SINGLE_NUMBER, &sti, NULL, of_metric));
    for (size_t seat = 0; seat < of_metric[1]; ++seat) {
        printf(
            "%s: T30 %.2f s, STI %.2f, %zu samples\n", names[seat], t30[seat], sti[seat], shape[3]);
    }

    // The geometry answers other questions, too: is the back seat in sight of the teacher?
    es_bvh bvh = 0;
    uint8_t visible = 0;
    must(es_bvh_create_from_scene(room, 0.0, ES_BUILDER_BINNED_SAH, 0, &bvh));
    must(es_bvh_visible(bvh, teacher, seats + 6, 1, 1, &visible));
    printf("the back seat is %s\n", visible ? "visible" : "hidden");

    must(es_release(bvh));
    must(es_release(result));
    must(es_release(room));
    return 0;
}
